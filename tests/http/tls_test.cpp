// SPDX-License-Identifier: Apache-2.0
#include <tests/http/web_client.hpp>  // before others, for Beast's sake
//
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <boost/asio/read.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <cstdio>
#include <fstream>
#include <palpate/math/errors.hpp>

namespace palpate::http {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using test::kToken;
using ::testing::HasSubstr;
using TlsStream = asio::ssl::stream<test::Tcp::socket>;

std::string get(const std::string& target, const std::string& more = "") {
  return "GET " + target + " HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer " + kToken + "\r\n" + more +
         "Connection: close\r\n\r\n";
}

/// A key and a certificate that it has signed itself, as PEM.
void make_certificate(const std::string& key_path, const std::string& certificate_path,
                      const char* password = nullptr) {
  const std::unique_ptr<EVP_PKEY, void (*)(EVP_PKEY*)> key(EVP_EC_gen("P-256"), EVP_PKEY_free);
  const std::unique_ptr<X509, void (*)(X509*)> certificate(X509_new(), X509_free);
  ASN1_INTEGER_set(X509_get_serialNumber(certificate.get()), 1);
  X509_gmtime_adj(X509_getm_notBefore(certificate.get()), -60);
  X509_gmtime_adj(X509_getm_notAfter(certificate.get()), 3600);
  X509_set_pubkey(certificate.get(), key.get());
  X509_NAME* name = X509_get_subject_name(certificate.get());
  X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC, reinterpret_cast<const unsigned char*>("localhost"), -1, -1, 0);
  X509_set_issuer_name(certificate.get(), name);
  X509_sign(certificate.get(), key.get(), EVP_sha256());
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> key_file(std::fopen(key_path.c_str(), "w"), std::fclose);
  PEM_write_PrivateKey(key_file.get(), key.get(), password != nullptr ? EVP_aes_256_cbc() : nullptr, nullptr, 0,
                       nullptr, const_cast<char*>(password));
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(certificate_path.c_str(), "w"), std::fclose);
  PEM_write_X509(file.get(), certificate.get());
}

class HttpTls : public test::Served {
 protected:
  void SetUp() override {
    Served::SetUp();
    make_certificate(file("key.pem"), file("certificate.pem"));
  }
  std::string file(const std::string& name) const { return path(name).string(); }

  ServerOptions secured(const std::string& certificate = "certificate.pem", const std::string& key = "key.pem") {
    ServerOptions options = defaults();
    options.certificate = path(certificate);
    options.key = path(key);
    return options;
  }

  std::string refusal(const ServerOptions& options) {
    try {
      Server server(options, [](const Request&, const Server::Reply&) {});
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }

  /// The handshake done; `version`: the only one that the client speaks, 0: any.
  std::unique_ptr<TlsStream> connect(int version = 0) {
    auto stream = std::make_unique<TlsStream>(io_, context_);
    if (version != 0) SSL_set_max_proto_version(stream->native_handle(), version);
    if (version != 0) SSL_set_min_proto_version(stream->native_handle(), version);
    stream->next_layer().connect(test::Tcp::endpoint(asio::ip::address_v4::loopback(), port()));
    stream->handshake(asio::ssl::stream_base::client, error_);
    return stream;
  }

  std::string talk(const std::string& request) {
    const auto stream = connect();
    asio::write(*stream, asio::buffer(request));
    std::string answer;
    asio::read(*stream, asio::dynamic_buffer(answer), error_);
    return answer;
  }

  asio::io_context io_;
  asio::ssl::context context_{asio::ssl::context::tls_client};
  boost::system::error_code error_;
};

TEST_F(HttpTls, SpeaksNothingElse) {
  start(secured());
  EXPECT_TRUE(server().secure());
  const std::string page = talk(get("/?token=" + kToken));
  EXPECT_EQ(error_, asio::error::eof) << "and not cut off";
  EXPECT_THAT(page, HasSubstr("HTTP/1.1 200 OK"));
  EXPECT_THAT(page, HasSubstr("; HttpOnly; SameSite=Strict; Path=/; Secure"));
  EXPECT_THAT(page, HasSubstr("connect-src 'self' wss://localhost;"));
  EXPECT_THAT(page, HasSubstr("<p>page</p>"));
  EXPECT_THAT(talk(get("/", "Origin: https://localhost\r\n")), HasSubstr(" 200 "));
  EXPECT_THAT(talk(get("/", "Origin: http://localhost\r\n")), HasSubstr(" 403 "));
  test::Raw plain(port());
  EXPECT_EQ(plain.say("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").hear().status, 0);
  EXPECT_TRUE(test::eventually([&] { return server().health().malformed == 1; }));
  EXPECT_THAT(server().health().last_refusal, HasSubstr("TLS: "));
}

TEST_F(HttpTls, VersionsFromOneTwoOn) {
  start(secured());
  for (const int version : {TLS1_2_VERSION, TLS1_3_VERSION}) {
    connect(version);
    EXPECT_FALSE(error_) << error_.message();
  }
  SSL_CTX_set_security_level(context_.native_handle(), 0);  // else the client would refuse by itself
  connect(TLS1_1_VERSION);
  EXPECT_TRUE(error_);
}

TEST_F(HttpTls, CarriesWebSockets) {
  start(secured());
  beast::websocket::stream<TlsStream> socket(std::move(*connect()));
  socket.set_option(beast::websocket::stream_base::decorator(
      [](beast::websocket::request_type& request) { request.set("Authorization", "Bearer " + kToken); }));
  const ClientId id = next_client([&] { socket.handshake("localhost", "/live"); });
  server().send(id, {std::make_shared<const std::string>(std::string(2 << 20, 'x')), true});
  beast::flat_buffer buffer;
  socket.read(buffer);
  EXPECT_EQ(buffer.size(), std::size_t{2 << 20});
  socket.write(asio::buffer("hello", 5));
  EXPECT_TRUE(test::eventually([&] { return events().size() == 2; }));
  EXPECT_EQ(events().back(), "1 text hello");
  finish();
  EXPECT_EQ(events().back(), "1 closed");
}

TEST_F(HttpTls, AHandshakeThatDoesNotComeIsEnded) {
  ServerOptions options = secured();
  options.times.request_s = 0.2;
  start(options);
  test::Raw silent(port());
  EXPECT_TRUE(silent.is_closed());
  EXPECT_EQ(server().health().timed_out, 1u);
}

TEST_F(HttpTls, IsNeededAwayFromLoopback) {
  ServerOptions options = secured();
  options.address = "0.0.0.0";
  start(options);
  EXPECT_THAT(talk(get("/")), HasSubstr(" 403 ")) << "localhost is none of its names there";
  std::string reached = get("/");
  reached.replace(reached.find("localhost"), 9, "127.0.0.1:1");
  EXPECT_THAT(talk(reached), HasSubstr(" 200 "));
}

TEST_F(HttpTls, SaysWhichFileIsWrong) {
  make_certificate(file("other.pem"), file("other_certificate.pem"));
  make_certificate(file("locked.pem"), file("locked_certificate.pem"), "secret");
  std::ofstream(file("empty.pem"));
  std::ofstream(file("text.pem")) << "no PEM\n";
  EXPECT_EQ(refusal(secured("none.pem")),
            "dashboard.certificate = " + file("none.pem") + ": cannot be read: No such file or directory");
  EXPECT_EQ(refusal(secured("certificate.pem", "none.pem")),
            "dashboard.key = " + file("none.pem") + ": cannot be read: No such file or directory");
  EXPECT_EQ(refusal(secured("empty.pem")),
            "dashboard.certificate = " + file("empty.pem") + ": cannot be read: it is empty");
  EXPECT_THAT(refusal(secured("text.pem")), HasSubstr("text.pem: expected a PEM certificate: "));
  EXPECT_THAT(refusal(secured("key.pem")), HasSubstr("key.pem: expected a PEM certificate: "));
  EXPECT_THAT(refusal(secured("certificate.pem", "text.pem")), HasSubstr("text.pem: expected a PEM private key"));
  EXPECT_THAT(refusal(secured("certificate.pem", "locked.pem")), HasSubstr("private key without a password"));
  EXPECT_EQ(refusal(secured("certificate.pem", "other.pem")),
            "dashboard.key = " + file("other.pem") +
                ": expected the key of dashboard.certificate = " + file("certificate.pem") + ": it does not match");
  ServerOptions alone = secured();
  alone.key.clear();
  EXPECT_EQ(refusal(alone), "dashboard.key: expected beside dashboard.certificate");
  EXPECT_EQ(refusal(secured()), "");
}

}  // namespace
}  // namespace palpate::http
