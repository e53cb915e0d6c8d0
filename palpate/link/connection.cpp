// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <netinet/tcp.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/write.hpp>
#include <palpate/link/connection.hpp>
#include <utility>

namespace palpate::link {

namespace asio = boost::asio;

namespace {

constexpr double kFirstWait_s = 0.05;
constexpr double kLongestConnect_s = 2.0;  // a dead address does not answer at all

std::chrono::steady_clock::duration duration_of(double seconds) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds));
}

/// Small messages leave at once, and the kernel itself asks after a peer that is silent for long.
void set_options(asio::ip::tcp::socket& socket) {
  boost::system::error_code ignored;  // none of them is needed
  socket.set_option(asio::ip::tcp::no_delay(true), ignored);
  socket.set_option(asio::socket_base::keep_alive(true), ignored);
  const std::pair<int, int> keep_alive[] = {{TCP_KEEPIDLE, 1}, {TCP_KEEPINTVL, 1}, {TCP_KEEPCNT, 2}};
  for (const auto& [name, value] : keep_alive)
    setsockopt(socket.native_handle(), IPPROTO_TCP, name, &value, sizeof value);
}

std::string words(const boost::system::error_code& error) {
  return error == asio::error::eof ? "closed by the peer" : error.message();
}

}  // namespace

Client::Connection::Connection(asio::io_context& io, const ClientOptions& options, Handlers handlers)
    : options_(options), handlers_(std::move(handlers)), resolver_(io), socket_(io), timer_(io) {
  health_.error = "not started";
}

template <typename Step>
auto Client::Connection::guarded(Step step) {
  return [self = shared_from_this(), attempt = attempt_, step](const Error& error, auto&&... rest) {
    if (attempt == self->attempt_) step(*self, error, rest...);
  };
}

void Client::Connection::start() {
  if (running_) return;
  running_ = true;
  wait_s_ = std::min(kFirstWait_s, options_.longest_wait_s);
  open();
}

void Client::Connection::stop() {
  running_ = false;
  health_.connected = false;
  health_.error = "stopped";
  close();
}

void Client::Connection::close() {
  ++attempt_;
  Error ignored;
  resolver_.cancel();
  socket_.close(ignored);
  timer_.cancel();
}

void Client::Connection::wait(double duration_s, void (Connection::*then)()) {
  timer_.expires_after(duration_of(duration_s));
  timer_.async_wait(guarded([then](Connection& self, const Error& error) {
    if (!error) (self.*then)();
  }));
}

void Client::Connection::open() {
  last_byte_ = Clock::now();
  timer_.expires_after(duration_of(kLongestConnect_s));
  timer_.async_wait(guarded([](Connection& self, const Error& error) {
    if (!error) self.lose(fmt::format("no answer within {} s", kLongestConnect_s));
  }));
  resolve();
}

/// A numeric address needs no resolver, nor the thread it runs in.
void Client::Connection::resolve() {
  const auto connect = [](Connection& self, const auto& endpoints) {
    asio::async_connect(self.socket_, endpoints, self.guarded([](Connection& me, const Error& error, const auto&) {
      error ? me.lose(words(error)) : me.connected();
    }));
  };
  Error no_number;
  const asio::ip::address address = asio::ip::make_address(options_.host, no_number);
  if (!no_number) return connect(*this, std::array{Tcp::endpoint(address, options_.port)});
  resolver_.async_resolve(options_.host, std::to_string(options_.port),
                          guarded([connect](Connection& self, const Error& error, const auto& endpoints) {
                            error ? self.lose(words(error)) : connect(self, endpoints);
                          }));
}

void Client::Connection::connected() {
  set_options(socket_);
  decoder_ = Decoder();
  last_byte_ = Clock::now();
  ++health_.connections;
  watch();
  ask();
  read();
  tell(true, "");
}

/// PLUS answers with the header version of the request, and says which transforms are valid in version 2 alone.
void Client::Connection::ask() {
  if (!options_.ask_for_tracking) return;
  request_.clear();
  encode(Message{.version = 2, .device = "Palpate", .time_s = 0.0, .body = StartTracking{}, .metadata = {}}, request_);
  asio::async_write(socket_, asio::buffer(request_), guarded([](Connection& self, const Error& error, std::size_t) {
                      if (error) self.lose(words(error));
                    }));
}

void Client::Connection::read() {
  socket_.async_read_some(asio::buffer(buffer_), guarded([](Connection& self, const Error& error, std::size_t count) {
                            if (error) return self.lose(words(error));
                            self.last_byte_ = Clock::now();
                            self.deliver(std::span(self.buffer_).first(count));
                          }));
}

/// A handler may stop the client: then there is nothing left to read from.
void Client::Connection::deliver(std::span<const std::byte> bytes) {
  const std::uint64_t attempt = attempt_;
  Message message;  // not kept: a large one would stay beside the next
  Decoder::Result result = Decoder::Result::kNeedsMore;
  while ((result = decoder_.take(bytes, message)) == Decoder::Result::kMessage) {
    wait_s_ = std::min(kFirstWait_s, options_.longest_wait_s);
    ++(std::holds_alternative<Skipped>(message.body) ? health_.skipped : health_.messages);
    if (handlers_.message) handlers_.message(message);
    if (attempt != attempt_) return;
  }
  if (result == Decoder::Result::kNeedsMore) return read();
  ++health_.malformed;
  lose("malformed message: " + decoder_.fault());
}

void Client::Connection::watch() {
  const double silent_s = std::chrono::duration<double>(Clock::now() - last_byte_).count();
  if (silent_s >= options_.silence_s) return lose(fmt::format("silent for {} s", options_.silence_s));
  wait(options_.silence_s - silent_s, &Connection::watch);
}

void Client::Connection::lose(const std::string& why) {
  close();
  wait(wait_s_, &Connection::open);
  wait_s_ = std::min(2.0 * wait_s_, options_.longest_wait_s);
  tell(false, fmt::format("{}:{}: {}", options_.host, options_.port, why));
}

/// Last in every step: the handler may do what it likes with the client.
void Client::Connection::tell(bool connected, const std::string& why) {
  if (connected == health_.connected && why == health_.error) return;
  health_.connected = connected;
  health_.error = why;
  if (handlers_.state) handlers_.state(connected, why);
}

}  // namespace palpate::link
