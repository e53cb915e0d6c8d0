// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/ssl.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <palpate/http/tls.hpp>
#include <palpate/math/errors.hpp>

namespace palpate::http {

namespace {

namespace ssl = boost::asio::ssl;
using Error = boost::system::error_code;

void expect_readable(const char* field, const std::filesystem::path& file) {
  errno = 0;
  std::ifstream in(file);
  if (!in || in.peek() == std::ifstream::traits_type::eof())
    throw InputError(fmt::format("dashboard.{} = {}: cannot be read: {}", field, file.string(),
                                 errno != 0 ? std::strerror(errno) : "it is empty"));
}

/// OpenSSL would ask the terminal.
int no_password(char*, int, int, void*) { return 0; }

}  // namespace

ssl::context tls_context(const std::filesystem::path& certificate, const std::filesystem::path& key) {
  expect_readable("certificate", certificate);
  expect_readable("key", key);
  ssl::context context(ssl::context::tls_server);
  SSL_CTX* native = context.native_handle();
  SSL_CTX_set_min_proto_version(native, TLS1_2_VERSION);
  SSL_CTX_set_options(native, SSL_OP_NO_COMPRESSION | SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  SSL_CTX_set_mode(native, SSL_MODE_RELEASE_BUFFERS);
  SSL_CTX_set_default_passwd_cb(native, no_password);
  Error error;
  context.use_certificate_chain_file(certificate.string(), error);
  if (error)
    throw InputError(fmt::format("dashboard.certificate = {}: expected a PEM certificate: {}", certificate.string(),
                                 error.message()));
  context.use_private_key_file(key.string(), ssl::context::pem, error);
  const bool mismatch = ERR_GET_LIB(static_cast<unsigned long>(error.value())) == ERR_LIB_X509;
  if (!error && SSL_CTX_check_private_key(native) == 1) return context;
  if (error && !mismatch)
    throw InputError(fmt::format("dashboard.key = {}: expected a PEM private key without a password: {}", key.string(),
                                 error.message()));
  throw InputError(fmt::format("dashboard.key = {}: expected the key of dashboard.certificate = {}: it does not match",
                               key.string(), certificate.string()));
}

}  // namespace palpate::http
