// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/sensing/catheter.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <span>
#include <vector>

namespace palpate {

/// A sensor at rest: its mean pose in the base frame, gross outliers left out.
struct MeanPose {
  Pose T_base_sensor;
  int count = 0;     ///< readings that were averaged; 0: never seen
  int outliers = 0;  ///< readings that were left out
};

/// Mean over the frames with from_s <= time <= to_s, in the order of Catheter::sensors. A reading counts as an outlier
/// beyond eight times the spread about the median (stated noise, or what the median deviation shows, if that is more).
std::vector<MeanPose> mean_poses(const Catheter& catheter, std::span<const TrackerFrame> frames, double from_s,
                                 double to_s);

}  // namespace palpate
