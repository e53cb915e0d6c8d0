// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

namespace palpate::service {

/// The host's clock: UTC when the program started, and from then on the steady clock, so that it never runs back.
class HostClock {
 public:
  /// [ns since 1970]
  std::int64_t now_ns() const {
    return started_ns_ + std::chrono::nanoseconds(std::chrono::steady_clock::now() - started_).count();
  }

 private:
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  std::int64_t started_ns_ = std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
};

inline constexpr double kSecondsPerNanosecond = 1e-9;
inline std::int64_t nanoseconds(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

}  // namespace palpate::service
