// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <palpate/service/played_truth.hpp>

namespace palpate::service {

const PlayedTruth::Moment* PlayedTruth::at(std::int64_t number) const {
  const auto found = std::lower_bound(moments.begin(), moments.end(), number,
                                      [](const Moment& moment, std::int64_t wanted) { return moment.number < wanted; });
  return found != moments.end() && found->number == number ? &*found : nullptr;
}

PlayedTruth truth_of(const Scenario& scenario, const VirtualRun& run) {
  PlayedTruth out;
  for (std::size_t i = 0; i < run.frames.size(); ++i)
    out.moments.push_back({run.frames[i].number, run.truth[i].force_tip_N, run.truth[i].wall_base_m});
  const Signal& twist = scenario.handle.twist_rad;
  const bool twists = twist.constant != 0.0 || !twist.sines.empty() || !twist.points.empty();
  if (const auto* const wall = std::get_if<WallLoad>(&scenario.load); wall != nullptr && !twists)
    out.wall_normal_base = wall->normal_base.normalized();
  return out;
}

}  // namespace palpate::service
