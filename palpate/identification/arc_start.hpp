// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/arc_model.hpp>

/// What fit_arc makes of its input before it fits: checks, what is asked, where a free clamp may stand.
namespace palpate {

/// Which components of the points' positions were measured: of all the same ones. Throws InputError otherwise, on arc
/// lengths outside the shaft and on distances that contradict them.
std::array<bool, 3> check_points(const Catheter& catheter, const ArcData& data);

std::vector<ArcObservation> observations_of(const Catheter& catheter, const ArcData& data);

/// Precurvature to start from, and clamp pose where it is free: the rod is laid onto the positions for some curvatures,
/// the best one stands.
struct ArcStart {
  Vector3d precurvature_per_m;
  Pose T_frame_base;
};
ArcStart start_of(const Catheter& catheter, const ArcModel& model, const std::array<bool, 3>& measured,
                  ClampKnowledge clamp);

/// The stated bend and those of a grid whose cost is least: of a bend by half a turn and more there are several minima.
std::vector<ArcVector> arc_starts(ArcModel& model, const Eigen::Matrix<double, 9, Eigen::Dynamic>& M,
                                  const Vector3d& stated_per_m, double length_m);

/// Direction of the bend that a free clamp keeps, its sense included: of the catheter's precurvature, or about d1 (d2
/// where only x was seen).
Eigen::Vector2d kept_direction(const Catheter& catheter, const std::array<bool, 3>& measured);

}  // namespace palpate
