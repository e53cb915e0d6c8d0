// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

/// A small, bounded web server: files that are compiled in, a JSON interface, WebSockets.
namespace palpate::http {

/// One file of the page: its path as asked for, its media type, its bytes, which outlive the server.
struct File {
  std::string_view path, type, body;
};

/// How long it waits; tests wait less.
struct ServerTimes {
  double request_s = 5.0;   ///< for a request to come whole (a handshake likewise), and for an answer to leave
  double stuck_s = 5.0;     ///< for a message to a client to leave
  double idle_s = 15.0;     ///< for the next request of one that has shown the token
  double handler_s = 30.0;  ///< for the handler to reply: 503 then
  double silent_s = 10.0;   ///< a client that says nothing is asked at half of it, and closed after it
};

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< any but this machine's loopback needs `certificate` and `key`
  std::uint16_t port = 0;             ///< 0: any free one
  /// Names by which a browser may call it, without the port, besides the address itself and, on loopback,
  /// `localhost`: what stands in Host and Origin.
  std::vector<std::string> hosts = {};
  std::filesystem::path certificate = {}, key = {};  ///< PEM; both or neither: with them it speaks TLS alone
  std::string token = {};                            ///< every request must bring it; see new_token()
  std::vector<File> files = {};
  /// WebSockets among them. Beyond, the oldest that has not shown the token yet makes room; where there is none such
  /// the new one is closed at once.
  std::size_t most_connections = 64;
  ServerTimes times = {};
};

struct Request {
  std::string method, target, body;
};
struct Answer {
  int status = 200;
  std::string body;  ///< JSON
};

/// Counted since the start; any thread may read.
struct ServerHealth {
  std::size_t connections = 0;  ///< now, clients among them
  std::size_t clients = 0;      ///< WebSockets now
  std::uint64_t accepted = 0;
  std::uint64_t refused = 0;       ///< closed: there were too many
  std::uint64_t unauthorized = 0;  ///< 401: no token, or a wrong one
  std::uint64_t forbidden = 0;     ///< 403: another Host or Origin
  std::uint64_t malformed = 0;     ///< closed: too large, no HTTP, no WebSocket frame
  std::uint64_t timed_out = 0;     ///< closed: a request that did not come
  std::uint64_t sent = 0;          ///< messages to clients
  std::uint64_t dropped = 0;       ///< messages that a slow client did not get
  std::uint64_t closed_stuck = 0;  ///< clients that took nothing for kStuck_s
  std::string last_refusal;        ///< of the latest 401, 403 or malformed one, for a person; holds no token
};

using ClientId = std::uint64_t;

/// What a client is sent. Bytes are shared: one buffer for all who get it.
struct Message {
  std::shared_ptr<const std::string> bytes;
  bool binary = false;
  bool droppable = false;  ///< left out where the client is slow: newer ones follow
};

/// What happens to clients; called on the server's thread.
struct ClientEvents {
  std::function<void(ClientId)> opened = {};
  std::function<void(ClientId, std::string)> text = {};
  std::function<void(ClientId)> closed = {};
};

/// HTTP/1.1 and WebSocket (at kSocketPath). Bounded in connections, sizes and time. In this order, before anything
/// else: a Host that is not its own is refused (403), an Origin that is not that Host (403), a request without the
/// token (401). The token is taken from `Authorization: Bearer TOKEN`, from `?token=TOKEN` of the target, or from the
/// cookie that a page gets which was asked for with it; it is compared in constant time and is written nowhere.
///
/// It lives on one thread of its own, the one that calls run(): a flood costs that thread, nobody else's.
class Server {
 public:
  /// From any thread, once.
  using Reply = std::function<void(const Answer&)>;
  /// Asked for every target that begins with /api, on the server's thread.
  using Handler = std::function<void(const Request&, const Reply&)>;

  static constexpr std::string_view kSocketPath = "/live";
  static constexpr std::size_t kMostBodyBytes = 64 * 1024;
  static constexpr std::size_t kMostHeaderBytes = 8 * 1024;
  static constexpr std::size_t kMostTextBytes = 4 * 1024;    ///< of a WebSocket message from a client
  static constexpr std::size_t kMostTextsASecond = 50;       ///< likewise; it is closed beyond
  static constexpr std::size_t kMostWaitingBytes = 8 << 20;  ///< of one client: it is closed beyond
  static constexpr std::size_t kMostWaitingRows = 4;         ///< droppable messages that wait for one client
  static constexpr int kLongestRequest_s = static_cast<int>(ServerTimes{}.request_s);
  static constexpr int kStuck_s = static_cast<int>(ServerTimes{}.stuck_s);

  /// Binds the port and reads the certificate. Throws InputError where that cannot be, and where the address is not of
  /// this machine's loopback and there is no TLS.
  Server(ServerOptions options, Handler handler, ClientEvents events = {});
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;
  bool secure() const;

  /// Until stop(). On the calling thread.
  void run();
  /// From any thread: run() returns, everything is closed.
  void stop();

  /// From any thread; a client that is gone is none.
  void send(ClientId client, Message message);
  /// From any thread.
  ServerHealth health() const;

 private:
  struct Parts;
  std::shared_ptr<Parts> parts_;
};

/// 128 random bits, as 32 hexadecimal digits.
std::string new_token();

}  // namespace palpate::http
