// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/estimation/force_gaussian.hpp>
#include <palpate/sensing/catheter.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <span>
#include <vector>

/// How well the force can be known, whatever the estimator, the shaft being known exactly.
namespace palpate::reproduction {

/// Root mean square over the frames of the least standard deviation, tip axes.
struct ForceBounds {
  Vector3d frame_N = Vector3d::Zero();     ///< an unbiased estimate from one frame
  Vector3d online_N = Vector3d::Zero();    ///< from the frames so far, of a force that moves as this one does
  Vector3d smoothed_N = Vector3d::Zero();  ///< from all frames, likewise
  Vector3d mean_N = Vector3d::Zero();      ///< of the mean over time: (1/n) sqrt(sum of the frames' variances)
};

/// Cramer-Rao: the information that each frame's raw poses hold on the true force, Lambda = J^T R^-1 J, J that of
/// ShapeModel at the truth, R the sensors' white noise. Precondition: `frames` good, as many as `force_tip_N`.
std::vector<Matrix3d> force_information(const Catheter& catheter, std::span<const TrackerFrame> frames,
                                        std::span<const Vector3d> force_tip_N);

/// One frame's bound is sqrt(diag Lambda^-1). With a law of motion (Tichavsky, Muravchik, Nehorai 1998): covariance of
/// Kalman filter and RTS smoother for constant velocity, whose white acceleration is the truth's on each axis,
///   q^2 = mean (change of rate over a frame)^2 / dt.
/// A law that knows more of the course (a rhythm) may go below the last two. Frames before `first` do not count.
ForceBounds force_bounds(std::span<const Matrix3d> information_per_N2, std::span<const Vector3d> force_tip_N,
                         double frame_s, std::size_t first);

}  // namespace palpate::reproduction
