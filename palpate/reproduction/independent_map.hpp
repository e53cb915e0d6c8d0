// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/reproduction/virtual_paper.hpp>

namespace palpate::reproduction {

/// The sequence of maxima of the posterior that the paper's cost has, found another way: the cost of each step,
///
///   |y_p - p(F)|^2 / R_p + |log(R(F)^T R_y)|^2 / R_r + |omega_y - omega(F)|^2 / R_w + (F - F-)^T P-^-1 (F - F-),
///
/// written down from rod solutions alone and minimised by Ceres with numeric derivatives; the covariance of the next
/// step from central differences. Nothing of estimation/ or ShapeModel is used. R step by step (one: for all). Returns
/// estimated minus true [N]; about 1 ms a step.
std::vector<Vector3d> independent_map_errors(const Catheter& catheter, const Course& course, double Q_N2,
                                             const std::vector<PaperNoise>& R,
                                             const Vector3d& start_N = Vector3d::Zero());

}  // namespace palpate::reproduction
