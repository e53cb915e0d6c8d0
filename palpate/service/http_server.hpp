// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace palpate::service {

struct HttpRequest {
  std::string method, target, body;
};
struct HttpAnswer {
  int status = 200;
  std::string body;  ///< JSON
};

/// Answers JSON over HTTP/1.1 on loopback. Bounded in connections, size and time; another Host than this machine's own
/// loopback, or another Origin, is refused, so that no page of the web can command it. Lives on the io_context's
/// thread.
class HttpServer {
 public:
  using Reply = std::function<void(const HttpAnswer&)>;
  /// The handler calls the reply once, from the io_context's thread, now or later.
  using Handler = std::function<void(const HttpRequest&, const Reply&)>;

  static constexpr std::size_t kMostConnections = 32;
  static constexpr std::size_t kMostBodyBytes = 64 * 1024;
  static constexpr int kLongest_s = 5;  ///< for a request to come, and for an answer to leave

  /// Throws InputError where the port cannot be bound.
  HttpServer(boost::asio::io_context& io, std::uint16_t port, Handler handler);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  std::uint16_t port() const;
  void stop();

 private:
  class Listener;
  std::shared_ptr<Listener> listener_;
};

}  // namespace palpate::service
