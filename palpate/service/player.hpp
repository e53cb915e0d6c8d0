// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <palpate/service/counters.hpp>
#include <palpate/service/frame_queue.hpp>
#include <palpate/service/host_clock.hpp>
#include <palpate/service/played_truth.hpp>
#include <palpate/service/wakeup.hpp>
#include <vector>

namespace palpate::service {

/// Frames that are all there before the first is played: a recording, a virtual experiment.
struct Reel {
  int catheter = 0;
  std::vector<TrackerFrame> frames = {};
  double speed = 1.0;  ///< 0: as fast as the observer takes them, none is dropped
  bool loop = false;
  CatheterCounters* counters = nullptr;
  PlayedTruth truth = {};  ///< of a simulation
};

/// Plays reels by the clock, all from one thread. A frame comes as long after the first as its time says; time that
/// steps back or stands still costs none. A reel that begins again goes on in time.
class Player {
 public:
  Player(const HostClock& clock, FrameQueue& queue, std::vector<Reel> reels);

  /// Until every reel has ended, or stop().
  void run();
  void stop() noexcept;

 private:
  struct Course {
    std::size_t next = 0;
    double shift_s = 0.0;   ///< added to the frame's own time
    double played_s = 0.0;  ///< of the reel's time, when `next` is due
    double round_s = 0.0;   ///< how long the reel lasts, one period behind its last frame
    bool ended = false;
  };
  std::int64_t due_ns(std::size_t reel) const;
  void play(std::size_t reel);
  void advance(std::size_t reel);

  const HostClock& clock_;
  FrameQueue& queue_;
  std::vector<Reel> reels_;
  std::vector<Course> courses_;
  std::int64_t started_ns_ = 0;
  Wakeup wakeup_;
  TrackerFrame frame_;
  std::atomic<bool> stopping_{false};
};

}  // namespace palpate::service
