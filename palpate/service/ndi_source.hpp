// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <palpate/ndi/tracker.hpp>
#include <palpate/service/counters.hpp>
#include <palpate/service/frame_queue.hpp>
#include <palpate/service/host_clock.hpp>
#include <palpate/service/settings.hpp>
#include <string>
#include <vector>

namespace palpate::service {

/// Poses from one NDI Aurora, for all catheters on its serial port. A frame of the device becomes one of every
/// catheter, with one number and one time.
class NdiSource {
 public:
  /// A catheter on this port; its index and where its frames are counted.
  struct Watched {
    int index = 0;
    const CatheterSettings* settings = nullptr;
    CatheterCounters* counters = nullptr;
  };
  /// `say`: an event, "connected" or "disconnected", with the reason; from run()'s thread.
  NdiSource(const HostClock& clock, FrameQueue& queue, const std::vector<Watched>& watched,
            std::function<void(const std::string& event, const std::string& why)> say);

  /// Until stop(); goes on trying where there is no device.
  void run() { tracker_.run(); }
  void stop() noexcept { tracker_.stop(); }
  ndi::TrackerHealth health() const { return tracker_.health(); }
  const std::string& port() const { return port_; }

 private:
  struct Target {
    int index;
    std::size_t first;  ///< of its readings in the device's frame
    CatheterCounters* counters;
    TrackerFrame frame;
  };
  static ndi::TrackerOptions tracker_options(const std::vector<Watched>& watched);
  void take(const TrackerFrame& frame, std::int64_t received_ns);

  FrameQueue& queue_;
  std::string port_;
  std::vector<Target> targets_;
  ndi::Tracker tracker_;
};

}  // namespace palpate::service
