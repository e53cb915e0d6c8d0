// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>  // before Beast, which forgets it
//
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <optional>
#include <string>
#include <tests/http/served.hpp>

namespace palpate::http::test {

namespace beast = boost::beast;
namespace websocket = boost::beast::websocket;

/// A WebSocket of Beast's own client that never waits for long.
class WebClient {
 public:
  using Error = boost::system::error_code;
  using Headers = std::vector<std::pair<std::string, std::string>>;

  /// `receive_bytes`: of the kernel's buffer; 0: the system's choice.
  explicit WebClient(std::uint16_t port, const Headers& headers = {{"Authorization", "Bearer " + kToken}},
                     const std::string& target = "/live", int receive_bytes = 0)
      : socket_(io_) {
    auto& tcp = socket_.next_layer().socket();
    tcp.open(Tcp::v4());
    if (receive_bytes > 0) tcp.set_option(boost::asio::socket_base::receive_buffer_size(receive_bytes));
    tcp.connect(Tcp::endpoint(boost::asio::ip::address_v4::loopback(), port));
    socket_.set_option(websocket::stream_base::decorator([headers](websocket::request_type& request) {
      for (const auto& [name, value] : headers) request.set(name, value);
    }));
    socket_.async_handshake(response_, "localhost", target, [this](const Error& error) { error_ = error; });
    run(5.0);
  }

  const Error& error() const { return error_; }
  int status() const { return static_cast<int>(response_.result_int()); }
  std::string header(const std::string& name) const { return std::string(response_[name]); }
  bool is_binary() const { return socket_.got_binary(); }
  int close_code() const { return socket_.reason().code; }

  bool say(const std::string& text, bool binary = false) {
    socket_.binary(binary);
    socket_.async_write(boost::asio::buffer(text), [this](const Error& error, std::size_t) { error_ = error; });
    run(5.0);
    return !error_;
  }

  /// The next message; none where the server has closed, or says nothing for so long.
  std::optional<std::string> hear(double longest_s = 5.0) {
    bool heard = false;
    buffer_.clear();
    socket_.async_read(buffer_, [this, &heard](const Error& error, std::size_t) {
      error_ = error;
      heard = !error;
    });
    run(longest_s);
    if (!heard) return std::nullopt;
    return beast::buffers_to_string(buffer_.data());
  }

  /// Below WebSocket.
  beast::tcp_stream& tcp() { return socket_.next_layer(); }

 private:
  void run(double longest_s) {
    io_.restart();
    io_.run_for(std::chrono::milliseconds(static_cast<int>(1e3 * longest_s)));
    if (io_.stopped()) return;
    beast::get_lowest_layer(socket_).cancel();
    io_.restart();
    io_.run_for(std::chrono::seconds(1));
  }

  boost::asio::io_context io_;
  websocket::stream<beast::tcp_stream> socket_;
  websocket::response_type response_;
  beast::flat_buffer buffer_;
  Error error_;
};

}  // namespace palpate::http::test
