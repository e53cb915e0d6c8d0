// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <palpate/service/counters.hpp>
#include <palpate/service/frame_queue.hpp>
#include <palpate/service/host_clock.hpp>
#include <palpate/service/live_assembler.hpp>
#include <palpate/service/settings.hpp>
#include <string>

namespace palpate::service {

/// Tracker CSV that is being written: header, then a row a sensor a frame, read as it comes. A line that is no such row
/// is passed over and told.
class StandardInput {
 public:
  /// `say`: an event "bad line" with what was wrong; from run()'s thread. `descriptor`: 0 but in tests.
  StandardInput(const HostClock& clock, FrameQueue& queue, int catheter, const CatheterSettings& settings,
                CatheterCounters& counters, std::function<void(const std::string&)> say, int descriptor = 0);

  /// Until the end of the input, or stop(). Throws InputError where the header is none.
  void run();
  void stop() noexcept { stopping_.store(true, std::memory_order_release); }

 private:
  void take_lines();
  void take_line();
  void send(const TrackerFrame* frame);

  const HostClock& clock_;
  FrameQueue& queue_;
  int catheter_;
  const CatheterSettings& settings_;
  CatheterCounters& counters_;
  std::function<void(const std::string&)> say_;
  int descriptor_;
  LiveAssembler frames_;
  std::string header_, line_, pending_;
  std::size_t line_number_ = 0;
  std::atomic<bool> stopping_{false};
};

}  // namespace palpate::service
