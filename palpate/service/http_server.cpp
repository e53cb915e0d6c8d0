// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <utility>  // before Beast, which forgets it
//
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <palpate/math/errors.hpp>
#include <palpate/service/http_server.hpp>

namespace palpate::service {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using Error = boost::system::error_code;

std::string error_body(const char* text) { return nlohmann::json{{"error", text}}.dump(); }

/// Of this machine's loopback, with or without a port.
bool is_loopback(beast::string_view host) {
  for (const beast::string_view name : {"127.0.0.1", "localhost", "[::1]"})
    if (host == name || (host.starts_with(name) && host.substr(name.size()).starts_with(":"))) return true;
  return false;
}

bool is_own_origin(beast::string_view origin) {
  constexpr beast::string_view kScheme = "http://";
  return origin.empty() || (origin.starts_with(kScheme) && is_loopback(origin.substr(kScheme.size())));
}

}  // namespace

class HttpServer::Listener : public std::enable_shared_from_this<Listener> {
 public:
  Listener(asio::io_context& io, std::uint16_t port, Handler handler)
      : acceptor_(io), retry_(io), handler_(std::move(handler)) {
    const tcp::endpoint endpoint(asio::ip::address_v4::loopback(), port);
    try {
      acceptor_.open(endpoint.protocol());
      acceptor_.set_option(asio::socket_base::reuse_address(true));
      acceptor_.bind(endpoint);
      acceptor_.listen();
    } catch (const boost::system::system_error& error) {
      throw InputError(fmt::format("control port 127.0.0.1:{}: cannot be opened: {}", port, error.code().message()));
    }
  }

  void accept() {
    acceptor_.async_accept([self = shared_from_this()](const Error& error, tcp::socket socket) {
      if (!self->acceptor_.is_open()) return;
      if (error) return self->accept_later();
      self->serve(std::move(socket));
      self->accept();
    });
  }
  void stop() {
    Error ignored;
    acceptor_.close(ignored);
    retry_.cancel();
  }
  std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

 private:
  class Connection;
  void serve(tcp::socket socket);
  /// No descriptor is left: trying again at once would only burn the processor.
  void accept_later() {
    retry_.expires_after(std::chrono::milliseconds(100));
    retry_.async_wait([self = shared_from_this()](const Error& error) {
      if (!error) self->accept();
    });
  }

  tcp::acceptor acceptor_;
  asio::steady_timer retry_;
  Handler handler_;
  std::size_t connections_ = 0;
};

/// One request, one answer, then the next; a connection that is slow is closed.
class HttpServer::Listener::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(std::shared_ptr<Listener> listener, tcp::socket socket)
      : listener_(std::move(listener)), stream_(std::move(socket)) {
    ++listener_->connections_;
  }
  ~Connection() { --listener_->connections_; }

  void read() {
    parser_.emplace();
    parser_->body_limit(kMostBodyBytes);
    parser_->header_limit(8 * 1024);
    stream_.expires_after(std::chrono::seconds(kLongest_s));
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](const Error& error, std::size_t) {
      if (!error) return self->take();
      if (error == http::error::body_limit) self->write(413, error_body("body: expected at most 65536 bytes"), false);
    });
  }

 private:
  void take() {
    const auto& request = parser_->get();
    const bool keep_alive = request.keep_alive();
    if (!is_loopback(request[http::field::host]) || !is_own_origin(request[http::field::origin]))
      return write(403, error_body("Host or Origin: expected this machine's loopback"), false);
    const bool posts = request.method() == http::verb::post;
    if (!posts && request.method() != http::verb::get)
      return write(405, error_body("method: expected GET or POST"), keep_alive);
    // A form of another page can send text, but not JSON.
    if (posts && !request[http::field::content_type].starts_with("application/json"))
      return write(415, error_body("Content-Type: expected application/json"), keep_alive);
    listener_->handler_({posts ? "POST" : "GET", std::string(request.target()), request.body()},
                        [self = shared_from_this(), keep_alive](const HttpAnswer& answer) {
                          self->write(answer.status, answer.body, keep_alive);
                        });
  }

  void write(int status, std::string body, bool keep_alive) {
    answer_ = {};
    answer_.result(static_cast<unsigned>(status));
    answer_.set(http::field::content_type, "application/json");
    answer_.set(http::field::cache_control, "no-store");
    answer_.keep_alive(keep_alive);
    answer_.body() = std::move(body) + "\n";
    answer_.prepare_payload();
    stream_.expires_after(std::chrono::seconds(kLongest_s));
    http::async_write(stream_, answer_, [self = shared_from_this(), keep_alive](const Error& error, std::size_t) {
      if (!error && keep_alive) return self->read();
      Error ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  std::shared_ptr<Listener> listener_;
  beast::tcp_stream stream_;
  beast::flat_static_buffer<96 * 1024> buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  http::response<http::string_body> answer_;
};

void HttpServer::Listener::serve(tcp::socket socket) {
  if (connections_ >= kMostConnections) return;  // the socket closes itself
  std::make_shared<Connection>(shared_from_this(), std::move(socket))->read();
}

HttpServer::HttpServer(asio::io_context& io, std::uint16_t port, Handler handler)
    : listener_(std::make_shared<Listener>(io, port, std::move(handler))) {
  listener_->accept();
}

HttpServer::~HttpServer() { stop(); }
std::uint16_t HttpServer::port() const { return listener_->port(); }
void HttpServer::stop() { listener_->stop(); }

}  // namespace palpate::service
