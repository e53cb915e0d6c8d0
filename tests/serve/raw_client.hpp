// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>  // before Asio, which forgets it
//
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <cerrno>
#include <span>
#include <tests/serve/eventually.hpp>

namespace palpate::serve_test {

/// A connection that may do what no library would: say nothing, read nothing, lie.
class RawClient {
 public:
  /// Throws where nobody listens. `receive_bytes`: what its kernel takes for it; 0: as ever.
  explicit RawClient(int port, int receive_bytes = 0) : socket_(io_) {
    using boost::asio::ip::tcp;
    socket_.open(tcp::v4());
    if (receive_bytes > 0) socket_.set_option(boost::asio::socket_base::receive_buffer_size(receive_bytes));
    socket_.connect({boost::asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(port)});
    socket_.non_blocking(true);
  }

  /// What the other side takes of it at once.
  std::size_t send(std::span<const std::byte> bytes) {
    boost::system::error_code error;
    return socket_.write_some(boost::asio::buffer(bytes.data(), bytes.size()), error);
  }

  /// Reads until the other side closes; false where it does not within so many seconds.
  bool closed_within(double longest_s) {
    std::array<std::byte, 65536> buffer;
    return eventually(
        [&] {
          boost::system::error_code error;
          do socket_.read_some(boost::asio::buffer(buffer), error);
          while (!error);
          return error != boost::asio::error::would_block;
        },
        longest_s);
  }

 private:
  boost::asio::io_context io_;
  boost::asio::ip::tcp::socket socket_;
};

}  // namespace palpate::serve_test
