// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace palpate::service {

/// The times that go out. A tracker that keeps UTC is believed, so that poses and forces of one frame have one time on
/// every screen; any other clock is moved to UTC once. Where it jumps, the host's clock carries on instead:
///
///   t_out = t_device + offset,   offset anew where t_device and the host's clock went apart by more than a second
///
/// Never runs back, never NaN.
class OutputClock {
 public:
  static constexpr double kKeepsUtc_s = 10.0;  ///< closer to the host's clock than this
  static constexpr double kJump_s = 1.0;

  double stamp(double device_s, double received_s) {
    const bool keeps_utc = std::abs(device_s - received_s) < kKeepsUtc_s;
    const double passed_s = started_ ? std::max(received_s - received_s_, 0.0) : 0.0;
    if (!started_) last_s_ = keeps_utc ? device_s : received_s;
    if (keeps_utc && device_s >= last_s_) offset_s_ = 0.0;
    double out_s = device_s + offset_s_;
    const bool follows = started_ && std::abs(out_s - last_s_ - passed_s) < kJump_s;
    if (!follows && !(keeps_utc && offset_s_ == 0.0)) {
      out_s = last_s_ + passed_s;
      if (std::isfinite(device_s)) offset_s_ = out_s - device_s;
    }
    started_ = true;
    received_s_ = std::max(received_s_, received_s);  // a frame that waited came before what was said of its silence
    return last_s_ = std::max(last_s_, out_s);
  }

 private:
  bool started_ = false;
  double offset_s_ = 0.0, last_s_ = 0.0, received_s_ = 0.0;
};

}  // namespace palpate::service
