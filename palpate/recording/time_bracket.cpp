// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <palpate/recording/time_bracket.hpp>

namespace palpate {

TimeBracket bracket_time(const std::vector<double>& times_s, double time_s) {
  const std::size_t last = times_s.size() - 1;
  if (!(time_s >= times_s.front())) return {0, 0, 0.0, false};
  if (time_s >= times_s.back()) return {last, last, 0.0, time_s == times_s.back()};
  const auto above = std::upper_bound(times_s.begin(), times_s.end(), time_s);
  const std::size_t high = static_cast<std::size_t>(above - times_s.begin());
  const std::size_t low = high - 1;
  return {low, high, (time_s - times_s[low]) / (times_s[high] - times_s[low]), true};
}

}  // namespace palpate
