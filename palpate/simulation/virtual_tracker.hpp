// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <palpate/rod/base_loads.hpp>
#include <palpate/sensing/catheter.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <random>
#include <vector>

/// A catheter without a patient: tip force over time in, what a tracker would have recorded out.
namespace palpate {

/// Force of the tissue on the tip [N], tip components, at a time [s].
using ForceSchedule = std::function<Vector3d(double time_s)>;

struct VirtualTrackerOptions {
  double rate_hz = 40.0;       ///< frames a second; range (0, 10000]
  double duration_s = 10.0;    ///< range (0, 86400]
  std::uint64_t seed = 1;      ///< same seed, same recording
  double missing_share = 0.0;  ///< of readings the tracker reports as MISSING; range [0, 1)
  double outlier_share = 0.0;  ///< of readings whose position is off by `outlier_m`, status OK; range [0, 1)
  double outlier_m = 25e-3;

  /// Throws InputError naming the field, its value and the range.
  void validate() const;
};

struct VirtualRecording {
  std::vector<TrackerFrame> frames;
  std::vector<Vector3d> force_tip_N;  ///< the truth, one a frame
  std::vector<Vector3d> force_base_N;
};

/// Runs the schedule on the catheter at Accuracy::kReference. Noise as the catheter's sensors state it: white, position
/// along the base axes, orientation R exp(n) in sensor axes; a tracked base included, standing at
/// BaseRegistration::T_tracker_base; each sensor in its own tracker's frame (Catheter::T_tracker_base). Throws
/// InputError on unusable options, and where a force has no equilibrium under the rod's own weight.
VirtualRecording simulate_tracker(const Catheter& catheter, const ForceSchedule& force,
                                  const VirtualTrackerOptions& options);

/// Contact with a beating, breathing wall: 1.2 Hz and 0.25 Hz, contact lost for 2 s in every 10 s. Peak about 0.15 N.
Vector3d beating_wall_force(double time_s);

/// Slowly turning force of constant size in the plane of d2 and d3, as of a weight swung over a pulley.
ForceSchedule turning_force(double size_N, double period_s);

}  // namespace palpate
