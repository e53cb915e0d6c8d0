// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <palpate/http/guard.hpp>
#include <palpate/http/server.hpp>
#include <utility>
#include <vector>

namespace palpate::http {

using Clock = std::chrono::steady_clock;

inline Clock::time_point in_seconds(double s) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

/// Who takes a place of the server: a connection that speaks HTTP, or a client (WebSocket).
class Member {
 public:
  virtual ~Member() = default;
  virtual void close() = 0;    ///< at once; a second time does nothing
  virtual void overdue() = 0;  ///< the deadline has passed

  Clock::time_point deadline = Clock::time_point::max();
  bool known = false;  ///< has shown the token
};

class Client {
 public:
  virtual ~Client() = default;
  virtual void send(Message message) = 0;
};

/// Runs what others wrote; false where it threw, which is their fault and must not end the server.
template <typename Call>
bool safely(const Call& call) {
  try {
    call();
    return true;
  } catch (...) {
    return false;
  }
}

/// What the connections share: the thread's io_context, the places, the clients, the counts. All of it on the server's
/// thread, but for deliver() and health().
class Hub {
 public:
  Hub(ServerOptions options, Server::Handler handler, ClientEvents events);

  /// Gives it a place; false where there is none. The oldest member that has not shown the token makes room: a flood
  /// turns over among itself, while who shows the token, as a browser does at once, stays.
  bool admit(const std::shared_ptr<Member>& member);
  void forget(const Member* member);
  /// The place of one goes to another: a connection has become a client.
  void replace(const Member* old, const std::shared_ptr<Member>& member);

  ClientId add_client(const std::shared_ptr<Client>& client);
  void remove_client(ClientId client);

  /// From any thread.
  void deliver(ClientId client, Message message);
  ServerHealth health() const;

  /// Looks again and again for members whose deadline has passed.
  void watch();
  void close_all();

  template <typename Change>
  void count(const Change& change) {
    const std::lock_guard lock(health_mutex_);
    change(health_);
  }
  void refusal(const std::string& text) {
    count([&](ServerHealth& health) { health.last_refusal = text; });
  }

  const ServerOptions options;
  const Server::Handler handler;
  const ClientEvents events;
  GuardRules rules;
  boost::asio::io_context io{1};

 private:
  static constexpr std::size_t kMostUnread = 1024;  ///< messages from other threads

  void hand_out();
  void count_members();

  boost::asio::steady_timer watch_{io};
  std::vector<std::shared_ptr<Member>> members_;  ///< oldest first
  std::map<ClientId, std::shared_ptr<Client>> clients_;
  ClientId latest_client_ = 0;
  bool ended_ = false;

  std::mutex inbox_mutex_;
  std::vector<std::pair<ClientId, Message>> inbox_;
  bool closed_ = false;

  mutable std::mutex health_mutex_;
  ServerHealth health_;
};

}  // namespace palpate::http
