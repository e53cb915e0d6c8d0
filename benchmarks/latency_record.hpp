// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate::latency {

/// Nearest rank: the least value that at least this share of `values` does not exceed. Precondition: not empty.
template <class T>
double percentile(std::vector<T> values, double share) {
  const auto count = static_cast<double>(values.size());
  const double rank = std::clamp(std::ceil(share * count), 1.0, count);
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank) - 1;
  std::nth_element(values.begin(), nth, values.end());
  return static_cast<double>(*nth);
}

struct Percentiles {
  double p50 = 0.0, p99 = 0.0, p99_9 = 0.0, max = 0.0;

  double tail() const { return p99_9 / p50; }
};

template <class T>
Percentiles percentiles(const std::vector<T>& values) {
  return {percentile(values, 0.5), percentile(values, 0.99), percentile(values, 0.999), percentile(values, 1.0)};
}

/// One row an update, written to before the first one: recording a row touches no new page.
struct Record {
  explicit Record(std::size_t updates) : wall_us(updates, -1.0F), cpu_us(updates, -1.0F), evaluations(updates, -1) {}

  std::vector<float> wall_us;    ///< what a caller waits
  std::vector<float> cpu_us;     ///< what this thread worked: without the time given to others
  std::vector<int> evaluations;  ///< rods integrated
  std::int64_t allocations = 0;
  std::int64_t minor_faults = 0, major_faults = 0, preemptions = 0;
};

/// The least time of each of `frames` frames that recur in turn: what is left without the machine's noise.
inline std::vector<float> least_by_frame(std::span<const float> times, std::size_t frames) {
  std::vector<float> least(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(std::min(frames, times.size())));
  for (std::size_t i = frames; i < times.size(); ++i) least[i % frames] = std::min(least[i % frames], times[i]);
  return least;
}

}  // namespace palpate::latency
