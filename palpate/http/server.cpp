// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ostream.h>

#include <palpate/http/connection.hpp>  // first, for Beast's sake
//
#include <optional>
#include <palpate/http/server.hpp>
#include <palpate/http/tls.hpp>
#include <palpate/math/errors.hpp>

namespace palpate::http {

namespace {

constexpr int kBacklog = 64;
constexpr std::size_t kMostAtOnce = 8, kMostAtOnceSecure = 2;  // a handshake costs a signature
constexpr std::chrono::milliseconds kPause{5}, kNoDescriptorPause{100};
constexpr int kSendBuffer_bytes = 64 * 1024;  // who does not read is soon seen not to

asio::ip::address address_of(const ServerOptions& options) {
  Error error;
  asio::ip::address address = asio::ip::make_address(options.address, error);
  if (error) throw InputError(fmt::format("dashboard.address = '{}': expected an IP address", options.address));
  return address;
}

std::optional<asio::ssl::context> tls_of(const ServerOptions& options) {
  if (options.certificate.empty() != options.key.empty())
    throw InputError(fmt::format("dashboard.{}: expected beside dashboard.{}",
                                 options.key.empty() ? "key" : "certificate",
                                 options.key.empty() ? "certificate" : "key"));
  if (!options.certificate.empty()) return tls_context(options.certificate, options.key);
  if (!address_of(options).is_loopback())
    throw InputError(
        fmt::format("dashboard.address = {}: expected TLS (certificate and key): without it, only this machine's "
                    "loopback",
                    options.address));
  return std::nullopt;
}

Tcp::acceptor listen(asio::io_context& io, const ServerOptions& options) {
  const Tcp::endpoint endpoint(address_of(options), options.port);
  Tcp::acceptor acceptor(io);
  Error error;
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(kBacklog, error);
  if (!error) acceptor.non_blocking(true, error);
  if (error)
    throw InputError(fmt::format("dashboard {}: cannot be opened: {}", fmt::streamed(endpoint), error.message()));
  return acceptor;
}

GuardRules rules_of(const ServerOptions& options, std::uint16_t port) {
  return {.hosts = own_hosts(options.address, address_of(options).is_loopback(), options.hosts),
          .secure = !options.certificate.empty(),
          .token = options.token,
          .cookie = fmt::format("palpate_{}", port)};
}

}  // namespace

/// The listener. It takes so many connections at once, then leaves the thread a pause: a flood meets the kernel's
/// backlog, not the processor.
struct Server::Parts {
  Parts(ServerOptions options, Handler handler, ClientEvents events)
      : hub(std::make_shared<Hub>(std::move(options), std::move(handler), std::move(events))),
        tls(tls_of(hub->options)),
        acceptor(listen(hub->io, hub->options)),
        pause(hub->io),
        most_at_once(
            std::clamp<std::size_t>(hub->options.most_connections / 4, 1, tls ? kMostAtOnceSecure : kMostAtOnce)) {
    port = acceptor.local_endpoint().port();
    hub->rules = rules_of(hub->options, port);
    hub->watch();
    wait();
  }

  void wait() {
    acceptor.async_wait(Tcp::acceptor::wait_read, [this](const Error& error) {
      if (acceptor.is_open()) error ? rest(kNoDescriptorPause) : take();
    });
  }

  void rest(std::chrono::milliseconds time) {
    pause.expires_after(time);
    pause.async_wait([this](const Error& error) {
      if (!error && acceptor.is_open()) wait();
    });
  }

  void take() {
    for (std::size_t i = 0; i < most_at_once; ++i) {
      Error error;
      Tcp::socket socket = acceptor.accept(error);
      if (error == asio::error::would_block) return wait();
      if (error == asio::error::connection_aborted) continue;
      if (error) return rest(kNoDescriptorPause);  // they do not come back at once
      welcome(std::move(socket));
    }
    rest(kPause);
  }

  void welcome(Tcp::socket socket) {
    Error ignored;
    socket.set_option(Tcp::no_delay(true), ignored);
    socket.set_option(asio::socket_base::send_buffer_size(kSendBuffer_bytes), ignored);
    if (tls)
      start(std::make_shared<Connection<SecureStream>>(hub, SecureStream(std::move(socket), *tls)));
    else
      start(std::make_shared<Connection<PlainStream>>(hub, std::move(socket)));
  }

  template <typename Any>
  void start(const std::shared_ptr<Any>& connection) {
    if (hub->admit(connection)) connection->start();
  }

  void stop() {
    Error ignored;
    acceptor.close(ignored);
    pause.cancel();
    hub->close_all();
  }

  std::shared_ptr<Hub> hub;
  std::optional<asio::ssl::context> tls;
  Tcp::acceptor acceptor;
  asio::steady_timer pause;
  std::size_t most_at_once;
  std::uint16_t port = 0;
};

Server::Server(ServerOptions options, Handler handler, ClientEvents events)
    : parts_(std::make_shared<Parts>(std::move(options), std::move(handler), std::move(events))) {}

Server::~Server() = default;
std::uint16_t Server::port() const { return parts_->port; }
bool Server::secure() const { return parts_->tls.has_value(); }

void Server::run() {
  // What throws here is a lack of memory: that connection is lost, the others are not.
  while (!safely([this] { parts_->hub->io.run(); })) {
  }
}

void Server::stop() {
  asio::post(parts_->hub->io, [parts = parts_.get()] { parts->stop(); });
}

void Server::send(ClientId client, Message message) { parts_->hub->deliver(client, std::move(message)); }
ServerHealth Server::health() const { return parts_->hub->health(); }

}  // namespace palpate::http
