// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <palpate/link/client.hpp>
#include <palpate/link/codec.hpp>
#include <span>
#include <string>
#include <vector>

namespace palpate::link {

/// What a Client does over and over: connect, read, lose, wait. Lives as long as one of its operations.
class Client::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(boost::asio::io_context& io, const ClientOptions& options, Handlers handlers);

  void start();
  void stop();
  const ClientHealth& health() const { return health_; }

 private:
  using Tcp = boost::asio::ip::tcp;
  using Clock = std::chrono::steady_clock;
  using Error = boost::system::error_code;

  /// Wraps a step of the present attempt: it is not taken once that attempt is over.
  template <typename Step>
  auto guarded(Step step);

  void open();
  void resolve();
  void connected();
  void ask();
  void read();
  void deliver(std::span<const std::byte> bytes);
  void watch();
  void lose(const std::string& why);
  void tell(bool connected, const std::string& why);
  void close();
  void wait(double duration_s, void (Connection::*then)());

  ClientOptions options_;
  Handlers handlers_;
  ClientHealth health_;
  Tcp::resolver resolver_;
  Tcp::socket socket_;
  boost::asio::steady_timer timer_;
  Decoder decoder_;
  std::array<std::byte, 16 * 1024> buffer_;
  std::vector<std::byte> request_;
  Clock::time_point last_byte_;
  double wait_s_ = 0.0;
  std::uint64_t attempt_ = 0;
  bool running_ = false;
};

}  // namespace palpate::link
