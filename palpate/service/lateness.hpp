// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace palpate::service {

/// How old a frame was when it came. Two clocks whose difference is not known tell that much: of all frames, the one
/// that came fastest was fresh, and what took longer waited on its way, in a computer that was too busy or a network
/// that stood still.
///
///   late = (t_received - t_device) - min over the latest half to whole minute
///
/// in which two quartz clocks drift apart by a few milliseconds, and after which a device whose clock was set while
/// nobody looked is believed again.
class Lateness {
 public:
  double late_s(double device_s, double received_s) {
    const double offset_s = received_s - device_s;
    if (!std::isfinite(offset_s)) return 0.0;
    if (!started_ || received_s - since_s_ > kWindow_s) {
      before_s_ = started_ ? fastest_s_ : offset_s;
      fastest_s_ = offset_s;
      since_s_ = received_s;
      started_ = true;
    }
    fastest_s_ = std::min(fastest_s_, offset_s);
    return offset_s - std::min(fastest_s_, before_s_);
  }
  void begin_anew() { started_ = false; }

 private:
  static constexpr double kWindow_s = 30.0;
  bool started_ = false;
  double fastest_s_ = 0.0, before_s_ = 0.0;  ///< of this window and of the one before
  double since_s_ = 0.0;
};

}  // namespace palpate::service
