// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <palpate/link/message.hpp>
#include <string>

namespace palpate::link {

struct ClientOptions {
  std::string host = "127.0.0.1";
  std::uint16_t port = 18944;    ///< that of a PLUS server
  bool ask_for_tracking = true;  ///< sends STT_TDATA (resolution 0) once connected, with a version 2 header
  double silence_s = 1.5;        ///< without a byte for so long the connection counts as dead; range (0, 3600]
  double longest_wait_s = 0.5;   ///< between two attempts to connect; the first come after 0.05, 0.1, 0.2 s ...
};

struct ClientHealth {
  bool connected = false;
  std::uint64_t connections = 0;  ///< made so far
  std::uint64_t messages = 0, skipped = 0, malformed = 0;
  std::string error;  ///< why there is no connection; empty where there is one
};

/// Connects to an OpenIGTLink server, and again whenever it is lost: closed, refused, without an answer for 2 s,
/// silent, malformed. The waits double up to longest_wait_s and begin anew with the first message. All calls and
/// handlers on the io_context's thread; a handler may stop or destroy the client. Memory: below 1 MiB whatever the
/// server sends.
class Client {
 public:
  struct Handlers {
    std::function<void(const Message&)> message;
    std::function<void(bool connected, const std::string& why)> state;  ///< at every change of either
  };
  /// Throws InputError on options outside their ranges.
  Client(boost::asio::io_context& io, const ClientOptions& options, Handlers handlers);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void start();
  void stop();  ///< cancels whatever goes on; calls no handler
  const ClientHealth& health() const;

 private:
  class Connection;
  std::shared_ptr<Connection> connection_;
};

}  // namespace palpate::link
