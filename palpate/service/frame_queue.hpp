// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/sensing/tracker_frame.hpp>
#include <palpate/service/wakeup.hpp>
#include <palpate/session/ring.hpp>

namespace palpate::service {

/// A frame on its way from a source to the observer.
struct ArrivedFrame {
  int catheter = 0;
  std::int64_t received_ns = 0;
  TrackerFrame frame;
};

/// From one source's thread to the observer's. Never blocks: where there is no room the frame is dropped, and whoever
/// puts it in counts it.
class FrameQueue {
 public:
  static constexpr std::size_t kFrames = 4096;

  FrameQueue(Wakeup& observer, std::size_t readings) : ring_(kFrames, prototype(readings)), observer_(observer) {}

  [[nodiscard]] bool put(int catheter, std::int64_t received_ns, const TrackerFrame& frame) {
    ArrivedFrame* const slot = ring_.free_slot();
    if (slot == nullptr) return false;
    slot->catheter = catheter;
    slot->received_ns = received_ns;
    slot->frame = frame;
    ring_.push();
    observer_.notify();
    return true;
  }

  const ArrivedFrame* front() { return ring_.front(); }
  void pop() { ring_.pop(); }
  bool empty() const { return ring_.size() == 0; }

 private:
  static ArrivedFrame prototype(std::size_t readings) {
    ArrivedFrame frame;
    frame.frame.readings.resize(readings);
    return frame;
  }
  session::Ring<ArrivedFrame> ring_;
  Wakeup& observer_;
};

}  // namespace palpate::service
