// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace palpate::ndi {

/// Times of frames: the host's clock at the reply's arrival, smoothed by the device's counter. With n the frames since
/// the one before, P the period as known so far, r the arrival:
///
///   predicted = t + n P,   e = r - predicted,   t <- predicted + a e,   P <- P + b e / n,   P within 1 % of nominal
///
/// (a second-order tracking loop, b = a^2 / (2 - a), Benedict and Bordner 1962). White jitter of arrival comes through
/// with about a sixth of its standard deviation; a host clock that runs faster or slower is followed. What remains is
/// the mean time from measurement to arrival, as with every tracker (`palpate identify delay`). Where e is beyond 0.25
/// s (a silence, a counter that began anew) t is the arrival. Never runs back: n P >= 24.7 ms is more than a 0.25 s,
/// and a new beginning is at least 1 ms later.
class FrameClock {
 public:
  static constexpr double kGain = 0.05, kPeriodGain = kGain * kGain / (2.0 - kGain);
  static constexpr double kDrift = 0.01, kLost_s = 0.25, kLeastStep_s = 1e-3;

  explicit FrameClock(double period_s = 1.0 / 40.0) : nominal_s_(period_s), period_s_(period_s) {}

  /// `frames`: by how much the counter went on; 0 or less: it began anew.
  double stamp(std::int64_t frames, double received_s) {
    if (!started_) {
      started_ = true;
      return last_s_ = received_s;
    }
    const double n = static_cast<double>(frames), predicted_s = last_s_ + n * period_s_,
                 error_s = received_s - predicted_s;
    if (frames <= 0 || !(std::abs(error_s) < kLost_s)) return last_s_ = std::max(received_s, last_s_ + kLeastStep_s);
    period_s_ =
        std::clamp(period_s_ + kPeriodGain * error_s / n, nominal_s_ * (1.0 - kDrift), nominal_s_ * (1.0 + kDrift));
    return last_s_ = std::max(predicted_s + kGain * error_s, last_s_ + kLeastStep_s);
  }

  double period_s() const { return period_s_; }

 private:
  double nominal_s_, period_s_, last_s_ = 0.0;
  bool started_ = false;
};

}  // namespace palpate::ndi
