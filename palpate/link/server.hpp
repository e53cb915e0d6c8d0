// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace palpate::link {

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 18945;            ///< beside a PLUS server on the same machine; 0: any free one
  std::size_t most_clients = 16;         ///< range [1, 1000]; one more is closed at once
  std::size_t queue_bytes = 256 * 1024;  ///< that may wait for one client; newer messages are dropped, and counted
  double stuck_s = 5.0;  ///< a client that has taken nothing for so long of what waits for it is closed; range (0, 10]
};

struct ServerHealth {
  std::size_t clients = 0;
  std::uint64_t accepted = 0, refused = 0;  ///< refused: above most_clients
  std::uint64_t sent = 0, dropped = 0;      ///< messages, over all clients
  std::uint64_t closed_stuck = 0, closed_malformed = 0;
};

/// An OpenIGTLink server that sends every message to all its clients (3D Slicer connects to it). A client that does not
/// read loses messages, then its connection; the others notice nothing. What clients send is read and bounded:
/// GET_CAPABIL is answered, a malformed message closes its sender alone. All calls on the io_context's thread. Memory:
/// below 1 MiB a client whatever it sends or does not read.
class Server {
 public:
  /// Throws InputError where the address cannot be bound, naming address, port and the system's reason.
  Server(boost::asio::io_context& io, const ServerOptions& options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;
  /// To all clients; never waits. Cost: a reference a client, the bytes are shared.
  void broadcast(const std::shared_ptr<const std::vector<std::byte>>& message);
  void stop();  ///< closes the port and every connection; no client is heard or served afterwards
  const ServerHealth& health() const;

 private:
  class Listener;
  std::shared_ptr<Listener> listener_;
};

}  // namespace palpate::link
