// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <palpate/observer/estimate.hpp>
#include <vector>

namespace palpate::service {

/// A number that one thread counts and any may read.
class Counter {
 public:
  void add(std::uint64_t count = 1) { value_.store(get() + count, std::memory_order_relaxed); }
  void set(std::uint64_t value) { value_.store(value, std::memory_order_relaxed); }
  std::uint64_t get() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> value_{0};
};

inline constexpr std::size_t kFrameTimes = 6;

/// What became of every frame and every reading of one catheter. Counted by the observer's thread.
struct CatheterCounters {
  Counter frames;
  std::array<Counter, kEstimateStatuses> by_status;
  std::array<Counter, kFrameTimes> by_time;
  std::array<std::array<Counter, kRejections>, kMaxSensors + 1> by_sensor_and_reason;
  Counter misses;         ///< frames whose estimate came later than a period after them, or was half stale by then
  Counter stale;          ///< times that it went stale
  Counter inconsistent;   ///< times that the consistency alarm rose
  Counter late_readings;  ///< came after their frame had been closed
  Counter queue_dropped;  ///< frames for which the observer's queue had no room
  Counter is_stale, is_inconsistent, period_ns, stale_after_ns, last_miss_ns;  ///< as they are now
  Counter measured_at_ns;  ///< the latest usable frame, by the host's clock
};

/// How long something took: a histogram of 100 bins a decade, 1 us to 10 s, so that a percentile is known within 2.4 %.
class LatencyHistogram {
 public:
  void add(std::int64_t latency_ns);
  /// Upper end of the bin that holds the share [s]; 0 where nothing was counted.
  double percentile_s(double share) const;
  double most_s() const { return 1e-9 * static_cast<double>(most_ns_.get()); }
  std::uint64_t count() const;
  struct Bin {
    double upper_s = 0.0;
    std::uint64_t count = 0;
  };
  /// Those that hold something.
  std::vector<Bin> bins() const;

 private:
  static double upper_end_s(std::size_t bin);
  static constexpr int kBinsADecade = 100, kDecades = 7;
  std::array<Counter, kBinsADecade * kDecades + 1> bins_;
  Counter most_ns_;
};

}  // namespace palpate::service
