// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/observer/estimate.hpp>

namespace palpate {

/// Mean force over a stretch of time in which the load stands still.
class ForceAverage {
 public:
  ForceAverage(double from_s, double to_s) : from_s_(from_s), to_s_(to_s) {}

  /// Frames outside the stretch, and held ones, do not count.
  void add(const Estimate& estimate);

  double from_s() const { return from_s_; }
  double to_s() const { return to_s_; }
  int frames() const { return frames_; }
  Vector3d force_tip_N() const { return force_tip_N_ / frames_; }
  Vector3d force_base_N() const { return force_base_N_ / frames_; }
  /// Mean covariance of a single frame, base components: errors of neighbouring frames are alike, so the mean's sigma
  /// is taken as a frame's, never as one shrunk by the number of frames.
  Matrix3d covariance_base_N2() const { return covariance_base_N2_ / frames_; }

 private:
  double from_s_, to_s_;
  int frames_ = 0;
  Vector3d force_tip_N_ = Vector3d::Zero(), force_base_N_ = Vector3d::Zero();
  Matrix3d covariance_base_N2_ = Matrix3d::Zero();
};

}  // namespace palpate
