// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <palpate/ndi/device.hpp>
#include <palpate/ndi/frame_clock.hpp>
#include <palpate/sensing/tracker_frame.hpp>

namespace palpate::ndi {

struct TrackerOptions {
  DeviceOptions device;
  std::size_t sensors = 1;           ///< readings of a frame
  std::vector<ToolName> tools = {};  ///< of the sensors, in their order; empty: choose_tools()
  double period_s = 1.0 / 40.0;      ///< of one count of the frame counter: the Aurora measures at 40 Hz
  double least_poll_s = 0.005;       ///< from one question to the next, at least
  double first_wait_s = 0.05;        ///< before the second attempt to connect; doubles
  double longest_wait_s = 0.5;
};

struct TrackerHealth {
  bool connected = false;
  std::uint64_t connections = 0;  ///< made so far
  std::uint64_t frames = 0, repeats = 0, malformed = 0, unanswered = 0;
  std::uint64_t out_of_volume = 0;  ///< readings
  std::string error;                ///< why there is no connection; empty where there is one
};

/// Poses from an NDI Aurora on a serial port, and again whenever it is lost: port gone, three questions without an
/// answer, ten malformed answers one after the other, the device reset, a tool plugged in. The waits double up to
/// longest_wait_s and begin anew with the first frame.
///
/// BX tells the latest frame, again and again: a frame is passed on when its number is new. The number is the newest of
/// the wanted handles'; a pose with an older one is not of this frame (kAbsent). One thread runs it; stop() and
/// health() from any. Allocates a few hundred bytes for each answer.
class Tracker {
 public:
  /// From run()'s thread. `now_ns`: since 1970, never back.
  struct Handlers {
    std::function<std::int64_t()> now_ns;
    std::function<void(const TrackerFrame&, std::int64_t received_ns)> frame;
    std::function<void(bool connected, const std::string& why)> state;  ///< at every change of either
  };
  Tracker(TrackerOptions options, Handlers handlers);

  /// Until stop(); ends the device's tracking then.
  void run();
  /// run() comes to its end within 0.2 s.
  void stop() noexcept { stopping_.store(true, std::memory_order_release); }
  TrackerHealth health() const;

 private:
  void connect_and_track();
  void follow(Device& device);
  void take(const BxReply& reply, std::int64_t now_ns);
  void fill(const BxReply& reply, std::uint32_t number);
  void say(bool connected, const std::string& why);
  void wait(double seconds) const;
  bool stopping() const { return stopping_.load(std::memory_order_acquire); }

  TrackerOptions options_;
  Handlers handlers_;
  std::atomic<bool> stopping_{false};
  LineMemory memory_;
  std::vector<std::uint8_t> handles_;
  FrameClock clock_;
  TrackerFrame frame_;
  std::uint32_t last_number_ = 0;
  bool any_frame_ = false, said_ = false;
  double wait_s_;
  mutable std::mutex mutex_;
  TrackerHealth health_;  // under mutex_
};

}  // namespace palpate::ndi
