// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <palpate/http/server.hpp>

namespace palpate::http {

/// What waits for one client, in order. Bounded: of what may be dropped the newest few stay, so that a slow page sees
/// the present; what may not be dropped overflows, and then the client has to go.
class Outbox {
 public:
  enum class Taken { kYes, kOneDropped, kOverflow };

  /// Cost: a search among what waits, which is short.
  Taken push(Message message) {
    const std::size_t size = message.bytes->size();
    bool dropped = false;
    if (message.droppable) {
      if (rows_ >= Server::kMostWaitingRows) dropped = drop_oldest();
      if (bytes_ + size > Server::kMostWaitingBytes) return Taken::kOneDropped;
    }
    if (bytes_ + size > Server::kMostWaitingBytes) return Taken::kOverflow;
    bytes_ += size;
    rows_ += message.droppable ? 1 : 0;
    waiting_.push_back(std::move(message));
    return dropped ? Taken::kOneDropped : Taken::kYes;
  }

  bool empty() const { return waiting_.empty(); }

  /// The oldest; it no longer counts as waiting.
  Message pop() {
    Message message = std::move(waiting_.front());
    waiting_.pop_front();
    forget(message);
    return message;
  }

 private:
  bool drop_oldest() {
    const auto oldest = std::ranges::find_if(waiting_, [](const Message& message) { return message.droppable; });
    if (oldest == waiting_.end()) return false;
    forget(*oldest);
    waiting_.erase(oldest);
    return true;
  }

  void forget(const Message& message) {
    bytes_ -= message.bytes->size();
    rows_ -= message.droppable ? 1 : 0;
  }

  std::deque<Message> waiting_;
  std::size_t bytes_ = 0, rows_ = 0;
};

}  // namespace palpate::http
