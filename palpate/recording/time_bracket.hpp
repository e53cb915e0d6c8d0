// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace palpate {

/// Where a time stands among samples: value = (1 - weight) * x[low] + weight * x[high].
struct TimeBracket {
  std::size_t low = 0;
  std::size_t high = 0;
  double weight = 0.0;
  bool inside = false;  ///< false: before the first sample, behind the last, or not a number; clamped
};

/// `times_s` strictly increasing and not empty.
TimeBracket bracket_time(const std::vector<double>& times_s, double time_s);

}  // namespace palpate
