// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/delay.hpp>

namespace palpate {

/// A force sensor's trace between its samples: cubics through them, with slopes of the parabola through three.
class ForceCurve {
 public:
  /// At least two samples, times strictly increasing. Keeps a reference.
  explicit ForceCurve(std::span<const TimedForce> samples);

  struct Point {
    bool known = false;  ///< false: outside the trace, or in a gap of it
    Vector3d force_N = Vector3d::Zero(), slope_N_per_s = Vector3d::Zero();
  };
  Point at(double time_s) const;
  double step_s() const { return step_s_; }  ///< median

 private:
  std::span<const TimedForce> samples_;
  std::vector<double> times_s_;
  std::vector<Vector3d> slopes_;
  double step_s_ = 0.0;
};

/// Both forces laid over each other at one delay; gain and offsets are the best ones there.
struct Overlay {
  std::size_t used = 0;
  double gain = 0.0;
  Vector3d offset_N = Vector3d::Zero();
  double cost = 0.0;          ///< weighted mean square of what remains, per number
  double unexplained = 0.0;   ///< the same with gain 0
  double sensor_power = 0.0;  ///< weighted mean square of F_sensor about its mean

  double explained() const { return unexplained > 0.0 ? 1.0 - cost / unexplained : 0.0; }
};

class DelayComparison {
 public:
  DelayComparison(std::span<const TimedForce> tracker, std::span<const TimedForce> sensor, const DelayOptions& options);

  Overlay overlay(double delay_s) const;
  /// Fills what holds at fit.delay_s: gain, offsets, residuals, sigmas.
  void finish(DelayFit& fit) const;
  double scan_step_s() const;

 private:
  using Vector5d = Eigen::Matrix<double, 5, 1>;  ///< d, g, b
  using Matrix5d = Eigen::Matrix<double, 5, 5>;
  void set_sigmas(const Matrix5d& A, const std::vector<Vector5d>& scores, DelayFit& fit) const;

  ForceCurve curve_;
  std::vector<TimedForce> tracker_;  ///< inside the trace at every delay of the range
  DelayOptions options_;
};

}  // namespace palpate
