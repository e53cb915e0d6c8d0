// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <palpate/link/peer.hpp>
#include <palpate/link/server.hpp>
#include <palpate/math/errors.hpp>
#include <set>
#include <utility>

namespace palpate::link {

namespace asio = boost::asio;
using Tcp = asio::ip::tcp;
using Error = boost::system::error_code;

namespace {

constexpr std::chrono::milliseconds kAcceptPause{100};  // no descriptor left: they do not come back at once

std::chrono::duration<double> check_period(double stuck_s) {
  return std::chrono::duration<double>(std::min(0.1 * stuck_s, 0.25));
}

void check_options(const ServerOptions& options) {
  if (options.most_clients < 1 || options.most_clients > 1000)
    throw InputError(fmt::format("most_clients = {}: expected 1 to 1000", options.most_clients));
  if (!(options.stuck_s > 0.0 && options.stuck_s <= 10.0))
    throw InputError(fmt::format("stuck_s = {}: expected (0, 10]", options.stuck_s));
}

Tcp::acceptor listen(asio::io_context& io, const ServerOptions& options) {
  Error error;
  const asio::ip::address address = asio::ip::make_address(options.address, error);
  if (error) throw InputError(fmt::format("address = '{}': expected an IP address", options.address));
  const Tcp::endpoint endpoint(address, options.port);
  Tcp::acceptor acceptor(io);
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error)
    throw InputError(fmt::format("{}:{}: cannot be listened on: {}", options.address, options.port, error.message()));
  return acceptor;
}

}  // namespace

class Server::Listener : public std::enable_shared_from_this<Listener> {
 public:
  Listener(asio::io_context& io, const ServerOptions& options)
      : options_(options), acceptor_(listen(io, options)), pause_(io), checks_(io) {}

  void start() {
    accept();
    check();
  }

  void stop() {
    Error ignored;
    acceptor_.close(ignored);
    pause_.cancel();
    checks_.cancel();
    for (const auto& peer : std::exchange(peers_, {})) peer->close();
    health_->clients = 0;
  }

  std::uint16_t port() const {
    Error closed;
    return acceptor_.local_endpoint(closed).port();
  }

  const ServerHealth& health() const { return *health_; }

  void broadcast(const SharedBytes& message) const {
    for (const auto& peer : peers_) peer->send(message);
  }

 private:
  void accept() {
    acceptor_.async_accept([self = shared_from_this()](const Error& error, Tcp::socket socket) {
      if (!self->acceptor_.is_open()) return;
      if (error) return self->pause();
      self->admit(std::move(socket));
      self->accept();
    });
  }

  void pause() {
    pause_.expires_after(kAcceptPause);
    pause_.async_wait([self = shared_from_this()](const Error& error) {
      if (!error && self->acceptor_.is_open()) self->accept();
    });
  }

  void admit(Tcp::socket socket) {
    if (peers_.size() >= options_.most_clients) {
      ++health_->refused;
      return;  // which closes the socket
    }
    ++health_->accepted;
    const auto peer = std::make_shared<Peer>(std::move(socket), options_, health_,
                                             [weak = weak_from_this()](const std::shared_ptr<Peer>& ended) {
                                               if (const auto self = weak.lock()) self->forget(ended);
                                             });
    peers_.insert(peer);
    health_->clients = peers_.size();
    peer->start();
  }

  void forget(const std::shared_ptr<Peer>& ended) {
    peers_.erase(ended);
    health_->clients = peers_.size();
  }

  void check() {
    checks_.expires_after(
        std::chrono::duration_cast<std::chrono::steady_clock::duration>(check_period(options_.stuck_s)));
    checks_.async_wait([self = shared_from_this()](const Error& error) {
      if (error || !self->acceptor_.is_open()) return;
      const auto peers = self->peers_;  // one that ends leaves the set
      for (const auto& peer : peers) peer->check(Peer::Clock::now());
      self->check();
    });
  }

  ServerOptions options_;
  Tcp::acceptor acceptor_;
  asio::steady_timer pause_, checks_;
  std::set<std::shared_ptr<Peer>> peers_;
  std::shared_ptr<ServerHealth> health_ = std::make_shared<ServerHealth>();
};

Server::Server(asio::io_context& io, const ServerOptions& options) {
  check_options(options);
  listener_ = std::make_shared<Listener>(io, options);
  listener_->start();
}

Server::~Server() { listener_->stop(); }

std::uint16_t Server::port() const { return listener_->port(); }

void Server::broadcast(const std::shared_ptr<const std::vector<std::byte>>& message) { listener_->broadcast(message); }

void Server::stop() { listener_->stop(); }

const ServerHealth& Server::health() const { return listener_->health(); }

}  // namespace palpate::link
