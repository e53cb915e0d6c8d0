// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <palpate/link/codec.hpp>
#include <palpate/link/server.hpp>
#include <span>
#include <vector>

namespace palpate::link {

using SharedBytes = std::shared_ptr<const std::vector<std::byte>>;

/// A server's end of one connection: a bounded queue out, a Decoder in. Lives as long as one of its operations.
class Peer : public std::enable_shared_from_this<Peer> {
 public:
  using Clock = std::chrono::steady_clock;
  Peer(boost::asio::ip::tcp::socket socket, const ServerOptions& options, std::shared_ptr<ServerHealth> health,
       std::function<void(const std::shared_ptr<Peer>&)> ended);

  void start();
  /// Queues a message, or drops and counts it where the queue has no room.
  void send(SharedBytes message);
  /// Ends the connection if its client has taken nothing for too long although there was something to take.
  void check(Clock::time_point now);
  void close();

 private:
  void read();
  void receive(std::span<const std::byte> bytes);
  void answer(const Message& question);
  void write();
  void written(std::size_t bytes);
  void end();

  boost::asio::ip::tcp::socket socket_;
  ServerOptions options_;
  std::shared_ptr<ServerHealth> health_;
  std::function<void(const std::shared_ptr<Peer>&)> ended_;
  Decoder decoder_;
  std::array<std::byte, 4096> buffer_;
  std::deque<SharedBytes> queue_;
  std::vector<boost::asio::const_buffer> gathered_;
  std::size_t queued_bytes_ = 0;
  std::size_t first_written_ = 0;  ///< bytes of the queue's first message that are on their way
  bool writing_ = false;
  std::uint64_t written_bytes_ = 0, taken_bytes_ = 0;
  Clock::time_point taken_at_;
};

}  // namespace palpate::link
