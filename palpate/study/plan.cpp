// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <palpate/study/counter_random.hpp>
#include <palpate/study/plan.hpp>

namespace palpate::study {

namespace {

// One key a purpose, so that no two of them share draws.
constexpr std::uint64_t kRunSeeds = 0x72756e73ULL, kHypercube = 0x6375626573ULL;

}  // namespace

double between(const Parameter& p, double share) {
  if (!p.logarithmic) return p.from + share * (p.to - p.from);
  const double from = std::log(p.from), to = std::log(p.to);  // their ratio may be more than the largest number
  return std::clamp(std::exp(from + share * (to - from)), p.from, p.to);
}

std::uint64_t Plan::grid_points() const {
  std::uint64_t points = 1;
  for (const Parameter& p : parameters)
    if (!p.sampled()) points *= p.values.size();
  return points;
}

RunKey run_key(const Plan& plan, std::uint64_t run) {
  RunKey key{.run = run, .point = run / plan.repeats, .repeat = run % plan.repeats};
  key.seed = mix(mix(plan.seed, kRunSeeds), plan.common_seeds ? key.repeat : run) >> 11U;
  return key;
}

std::vector<nlohmann::json> point_values(const Plan& plan, std::uint64_t point) {
  const std::uint64_t sample = point % plan.samples;
  std::uint64_t grid = point / plan.samples;
  std::vector<nlohmann::json> values(plan.parameters.size());
  for (std::size_t j = plan.parameters.size(); j-- > 0;) {
    const Parameter& p = plan.parameters[j];
    if (p.sampled()) {
      const std::uint64_t key = mix(mix(plan.seed, kHypercube), j);
      values[j] = between(p, latin_coordinate(sample, plan.samples, key));
    } else {
      values[j] = p.values[grid % p.values.size()];
      grid /= p.values.size();
    }
  }
  return values;
}

RunRange shard_range(const Plan& plan, std::uint64_t shard) {
  const std::uint64_t first = shard * plan.shard_runs;
  return {first, std::min(first + plan.shard_runs, plan.runs())};
}

}  // namespace palpate::study
