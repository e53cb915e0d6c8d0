// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace palpate::service {

/// How long a silence may last. A sensor that is lost is silence, and an old force must not be taken for a live one:
/// the limit is three of the source's own periods, or `least`, whichever is more. The period is the median of those by
/// the host's clock, or by the device's where that is longer: frames that waited come in bursts.
class Staleness {
 public:
  static constexpr std::int64_t kPeriods = 3;
  static constexpr std::int64_t kMost_ns = 2'000'000'000;  ///< whatever the period

  explicit Staleness(std::int64_t least_ns = 100'000'000) : least_ns_(least_ns) {}

  /// `device_step_ns`: since the frame before, as the device says.
  void frame(std::int64_t received_ns, std::int64_t device_step_ns) {
    if (last_ns_ > 0) {
      const std::size_t at = count_++ % kWindow;
      host_ns_[at] = received_ns - last_ns_;
      device_ns_[at] = device_step_ns;
      period_ns_ = std::max(median(host_ns_), median(device_ns_));
    }
    last_ns_ = received_ns;
    stale_ = false;
  }

  bool started() const { return last_ns_ > 0; }
  bool stale() const { return stale_; }
  void say_stale() { stale_ = true; }
  std::int64_t period_ns() const { return period_ns_; }  ///< median of the latest; 0: not known yet
  std::int64_t limit_ns() const { return std::clamp(kPeriods * period_ns_, least_ns_, std::max(least_ns_, kMost_ns)); }
  std::int64_t deadline_ns() const { return last_ns_ + limit_ns(); }

 private:
  static constexpr std::size_t kWindow = 15;
  using Steps = std::array<std::int64_t, kWindow>;
  std::int64_t median(Steps steps) const {
    const auto known = steps.begin() + static_cast<std::ptrdiff_t>(std::min(count_, kWindow));
    const auto middle = steps.begin() + (known - steps.begin()) / 2;
    std::nth_element(steps.begin(), middle, known);
    return *middle;
  }

  std::int64_t least_ns_;
  Steps host_ns_{}, device_ns_{};
  std::size_t count_ = 0;
  std::int64_t last_ns_ = 0, period_ns_ = 0;
  bool stale_ = false;
};

}  // namespace palpate::service
