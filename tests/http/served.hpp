// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <palpate/http/server.hpp>
#include <string>
#include <tests/recording/temporary_folder.hpp>
#include <thread>
#include <vector>

namespace palpate::http::test {

using Tcp = boost::asio::ip::tcp;

inline const std::string kToken = "0123456789abcdef0123456789abcdef";

inline bool eventually(const std::function<bool()>& holds, double longest_s = 5.0) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(longest_s);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

struct Response {
  int status = 0;  ///< 0: the server closed without an answer
  std::map<std::string, std::string> headers = {};
  std::string body = {};
};

/// A connection on which anything can be said; whatever is waited for comes within seconds or not at all.
class Raw {
 public:
  explicit Raw(std::uint16_t port) {
    stream_.expires_after(std::chrono::seconds(8));
    stream_.connect(Tcp::endpoint(boost::asio::ip::address_v4::loopback(), port));
  }
  Raw& say(const std::string& text) {
    stream_ << text << std::flush;
    return *this;
  }
  /// `bodyless`: the answer to a HEAD.
  Response hear(bool bodyless = false) {
    Response out;
    std::string line;
    if (!std::getline(stream_, line) || line.size() < 12) return out;
    out.status = std::stoi(line.substr(9, 3));
    while (std::getline(stream_, line) && line != "\r") {
      const std::size_t colon = line.find(':');
      out.headers[line.substr(0, colon)] = line.substr(colon + 2, line.size() - colon - 3);
    }
    out.body.resize(bodyless ? 0
                             : std::stoul(out.headers.count("Content-Length") ? out.headers["Content-Length"] : "0"));
    stream_.read(out.body.data(), static_cast<std::streamsize>(out.body.size()));
    return out;
  }
  bool is_closed() {
    stream_.clear();
    return stream_.get() == std::char_traits<char>::eof() && stream_.error() != boost::asio::error::operation_aborted;
  }
  bool good() const { return static_cast<bool>(stream_); }

 private:
  Tcp::iostream stream_;
};

/// A server that runs, with three files, an /api that echoes, and a memory of what its clients did.
class Served : public palpate::test::TemporaryFolder {
 protected:
  ~Served() override { finish(); }

  static ServerOptions defaults() {
    return {.token = kToken,
            .files = {{"/", "text/html; charset=utf-8", "<p>page</p>"},
                      {"/dashboard.js", "text/javascript", kScript},
                      {"/dashboard.css", "text/css", "p{}"}}};
  }

  void start(ServerOptions options = defaults()) {
    server_ = std::make_unique<Server>(
        std::move(options), [this](const Request& request, const Server::Reply& reply) { answer(request, reply); },
        ClientEvents{[this](ClientId id) { note("opened", id); },
                     [this](ClientId id, const std::string& text) { note("text " + text, id); },
                     [this](ClientId id) { note("closed", id); }});
    thread_ = std::thread([this] { server_->run(); });
  }

  void finish() {
    if (server_) server_->stop();
    if (thread_.joinable()) thread_.join();
    for (std::thread& late : late_) late.join();
    late_.clear();
    server_.reset();
  }

  std::uint16_t port() const { return server_->port(); }
  Server& server() { return *server_; }

  Response ask(const std::string& method, const std::string& target, const std::string& headers = "",
               const std::string& body = "") {
    return Raw(port()).say(text(method, target, headers, body)).hear(method == "HEAD");
  }
  /// With the token, as a script shows it.
  Response asked(const std::string& method, const std::string& target, const std::string& headers = "",
                 const std::string& body = "") {
    return ask(method, target, bearer() + headers, body);
  }
  static std::string bearer() { return "Authorization: Bearer " + kToken + "\r\n"; }
  static std::string text(const std::string& method, const std::string& target, const std::string& headers,
                          const std::string& body = "") {
    const bool named = headers.find("Host:") != std::string::npos;
    return method + " " + target + " HTTP/1.1\r\n" + (named ? "" : "Host: localhost\r\n") + headers +
           (body.empty() ? "" : "Content-Length: " + std::to_string(body.size()) + "\r\n") + "\r\n" + body;
  }

  std::vector<std::string> events() const {
    const std::lock_guard lock(mutex_);
    return events_;
  }
  std::optional<ClientId> latest_client() const {
    const std::lock_guard lock(mutex_);
    return latest_client_;
  }
  /// The client that the next connection becomes.
  ClientId next_client(const std::function<void()>& connect) {
    const std::optional<ClientId> before = latest_client();
    connect();
    EXPECT_TRUE(eventually([&] { return latest_client() != before; }));
    return latest_client().value_or(0);
  }

  static constexpr std::string_view kScript = "let a = 1;";
  /// Of the latest request; set before start().
  std::function<void(const Request&, const Server::Reply&)> other_answer_ = {};

 private:
  void answer(const Request& request, const Server::Reply& reply) {
    if (other_answer_) return other_answer_(request, reply);
    const Answer echo{200, request.method + " " + request.target + " " + request.body};
    if (request.target == "/api/never") return;
    if (request.target == "/api/throws") throw std::runtime_error(request.target);
    if (request.target == "/api/missing") return reply({404, "{}"});
    if (request.target != "/api/late") return reply(echo);
    late_.emplace_back([reply, echo] {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      reply(echo);
      reply({500, "a second time"});
    });
  }

  void note(const std::string& what, ClientId id) {
    const std::lock_guard lock(mutex_);
    events_.push_back(std::to_string(id) + " " + what);
    if (what == "opened") latest_client_ = id;
  }

  mutable std::mutex mutex_;
  std::vector<std::string> events_;
  std::optional<ClientId> latest_client_;
  std::vector<std::thread> late_;
  std::unique_ptr<Server> server_;
  std::thread thread_;
};

}  // namespace palpate::http::test
