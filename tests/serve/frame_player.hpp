// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <tests/serve/plus_server.hpp>

namespace palpate::serve_test {

/// A tracker that runs: frames at a rate from a thread of its own, from a recording that begins again at its end, each
/// of the time at which it is sent. Until it is stopped or destroyed, or the program has gone.
class FramePlayer {
 public:
  FramePlayer(PlusServer& plus, const WireFrames& recording, double rate_hz)
      : thread_([this, &plus, recording, rate_hz] { run(plus, recording, rate_hz); }) {}
  ~FramePlayer() { stop(); }
  FramePlayer(const FramePlayer&) = delete;
  FramePlayer& operator=(const FramePlayer&) = delete;

  /// What was sent.
  WireFrames stop() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
    return sent_;
  }
  std::size_t sent() const { return count_; }

 private:
  void run(PlusServer& plus, const WireFrames& recording, double rate_hz) {
    const Clock::time_point start = Clock::now();
    while (!stopping_) {
      WireFrame frame = recording[count_ % recording.size()];
      frame.time_s = wire_time(utc_s());
      if (!plus.send(frame)) return;
      sent_.push_back(std::move(frame));
      const std::chrono::duration<double> due(static_cast<double>(++count_) / rate_hz);
      std::this_thread::sleep_until(start + std::chrono::duration_cast<Clock::duration>(due));
    }
  }

  std::atomic<bool> stopping_{false};
  std::atomic<std::size_t> count_{0};
  WireFrames sent_;  // of the thread, until it has ended
  std::thread thread_;
};

}  // namespace palpate::serve_test
