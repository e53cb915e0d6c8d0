// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <malloc.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <tests/link/example_messages.hpp>

namespace palpate::link::test {

using Tcp = boost::asio::ip::tcp;

/// Runs the handlers until something holds; false where it does not within so many seconds.
inline bool run_until(boost::asio::io_context& io, const std::function<bool()>& holds, double longest_s = 5.0) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(longest_s);
  while (!holds()) {
    if (std::chrono::steady_clock::now() > end) return false;
    io.restart();
    io.run_one_for(std::chrono::milliseconds(2));
  }
  return true;
}

inline void run_for(boost::asio::io_context& io, double duration_s) {
  run_until(
      io, [] { return false; }, duration_s);
}

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

inline std::size_t entries(const char* folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}
inline std::size_t open_descriptors() { return entries("/proc/self/fd"); }
inline std::size_t threads() { return entries("/proc/self/task"); }

/// What this process has of its heap; 0 under a sanitizer, which has a heap of its own.
inline std::size_t heap_bytes() {
  const struct mallinfo2 heap = mallinfo2();
  return heap.uordblks + heap.hblkhd;
}

/// A server of the tests: does with every connection what it is told to.
class Acceptor {
 public:
  using Serve = std::function<void(const std::shared_ptr<Tcp::socket>&)>;
  Acceptor(boost::asio::io_context& io, Serve serve, std::uint16_t port = 0)
      : acceptor_(io, Tcp::endpoint(boost::asio::ip::address_v4::loopback(), port)), serve_(std::move(serve)) {
    accept();
  }
  std::uint16_t port() const { return acceptor_.local_endpoint().port(); }
  int accepted() const { return accepted_; }

 private:
  void accept() {
    acceptor_.async_accept([this](const boost::system::error_code& error, Tcp::socket socket) {
      if (error) return;
      ++accepted_;
      serve_(std::make_shared<Tcp::socket>(std::move(socket)));
      accept();
    });
  }

  Tcp::acceptor acceptor_;
  Serve serve_;
  int accepted_ = 0;
};

/// A client of the tests. It connects at once: the system does so before the server accepts.
inline Tcp::socket connected(boost::asio::io_context& io, std::uint16_t port) {
  Tcp::socket socket(io);
  socket.connect({boost::asio::ip::address_v4::loopback(), port});
  return socket;
}

/// Reads and decodes as fast as it can, until the connection ends.
class Reader {
 public:
  explicit Reader(Tcp::socket socket) : socket_(std::move(socket)) { read(); }
  Tcp::socket& socket() { return socket_; }

  std::vector<Message> messages;
  std::size_t bytes = 0;
  bool ended = false;
  std::string fault;

 private:
  void read() {
    socket_.async_read_some(boost::asio::buffer(buffer_),
                            [this](const boost::system::error_code& error, std::size_t n) {
                              if (error == boost::asio::error::operation_aborted) return;
                              ended = static_cast<bool>(error);
                              if (ended) return;
                              bytes += n;
                              std::span<const std::byte> piece(buffer_.data(), n);
                              Message message;
                              while (decoder_.take(piece, message) == Decoder::Result::kMessage)
                                messages.push_back(message);
                              fault = decoder_.fault();
                              read();
                            });
  }

  Tcp::socket socket_;
  Decoder decoder_;
  std::array<std::byte, 65536> buffer_;
};

}  // namespace palpate::link::test
