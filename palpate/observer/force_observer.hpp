// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <palpate/estimation/motion_filter.hpp>
#include <palpate/estimation/smoother.hpp>
#include <palpate/observer/estimate.hpp>
#include <palpate/observer/frame_clock.hpp>
#include <palpate/observer/frame_explainer.hpp>
#include <palpate/observer/options.hpp>
#include <palpate/observer/uncertainty.hpp>
#include <vector>

namespace palpate {

/// Feels the force on a catheter's tip through its shape: a tracker frame in, an estimate out.
///
///   x_k = A x_(k-1) + eta_k,   F_k = H x_k     how the force moves                       (10), MotionFilter
///   y_k = h(F_k, p) + w_k                      what the sensors see of the rod           (11), ShapeModel
///
/// Right from any starting force (FrameExplainer); process noise and rhythm are found from the data. p: what the
/// catheter file does not know exactly (UncertainParameters). Stiffness and precurvature are estimated where asked for
/// (14)-(16); all else widens the force's sigma, and its share is told (ForceUncertainty).
///
/// update() neither allocates, throws, locks, logs nor looks at a clock. Its work is bounded
/// (FrameExplainer::most_evaluations; usually three rod solutions). One object a catheter and a thread.
class ForceObserver {
 public:
  /// Throws InputError where catheter or options are not usable.
  ForceObserver(const Catheter& catheter, const ObserverOptions& options);

  /// Frames in time order; `frame.readings` as Catheter::sensors (a tracked base last).
  Estimate update(const TrackerFrame& frame);

  /// The force `ahead_s` after the latest frame, tip axes, with its covariance. n steps ahead: n frame times.
  ForceGaussian forecast(double ahead_s) const { return motion_.forecast(ahead_s); }

  /// Orientation of the tip in the base under a force, a tendon's pull and the handle's bend, the shaft being as it is
  /// believed to be now; one rod solution. Pull and bend stay set, as those of the latest frame do.
  Matrix3d R_base_tip(const Vector3d& force_tip_N, const TendonReading& tendon, const BendReading& bend = {});

  const MotionFilter& motion() const { return motion_; }
  const ForceUncertainty& uncertainty() const { return uncertainty_; }

 private:
  void take_loads(const TrackerFrame& frame);
  void take_bend(const BendReading& bend);
  void look_back(double time_s);
  Estimate report(double time_s, FrameTime time, EstimateStatus status);

  Catheter catheter_;
  ObserverOptions options_;
  UncertainParameters parameters_;
  ForceUncertainty uncertainty_;
  FrameClock clock_;
  FrameExplainer explainer_;
  MotionFilter motion_;

  Measurement measurement_;
  Matrix3d R_base_tip_;
  Eigen::Vector2d bend_per_m_ = Eigen::Vector2d::Zero();  ///< of the latest frame that had one
  Observability observability_;
  bool updated_ = false;
  std::int64_t evaluations_before_ = 0;

  std::optional<FixedLagSmoother> lag_;
  std::vector<double> times_s_;  ///< of the frames that lag_ remembers: a ring
  std::size_t frames_ = 0;
};

}  // namespace palpate
