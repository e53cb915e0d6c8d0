// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <palpate/simulation/virtual_run.hpp>
#include <vector>

namespace palpate::service {

/// What a simulation that is played knows of its frames, for those who look at it; the observer never sees it.
struct PlayedTruth {
  struct Moment {
    std::int64_t number = 0;  ///< TrackerFrame::number
    Vector3d force_tip_N = Vector3d::Zero();
    Vector3d wall_base_m = Vector3d::Zero();  ///< a point of the wall; NaN where there is none
  };
  std::vector<Moment> moments;               ///< by number
  std::optional<Vector3d> wall_normal_base;  ///< of unit length, towards the catheter; none where the handle twists and
                                             ///< it does not stand still

  /// Null where nothing is known of that frame.
  const Moment* at(std::int64_t number) const;
};

/// Precondition: a run of this scenario.
PlayedTruth truth_of(const Scenario& scenario, const VirtualRun& run);

}  // namespace palpate::service
