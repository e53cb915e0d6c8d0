// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <palpate/estimation/adaptation.hpp>
#include <palpate/estimation/consistency.hpp>
#include <palpate/estimation/kalman.hpp>
#include <palpate/observer/estimate.hpp>
#include <palpate/observer/frame_clock.hpp>
#include <palpate/observer/options.hpp>
#include <palpate/sensing/shape_model.hpp>

namespace palpate {

/// Feels the force on a catheter's tip through its shape: a tracker frame in, an estimate out.
///
///   F_k = F_(k-1) + eta_k,  eta ~ N(0, q^2 dt I)          the force walks at random            (10)
///   y_k = h(F_k) + w_k                                   what the sensors see of the rod       (11)
///
/// update() neither allocates, throws, locks, logs nor looks at a clock. Its work is bounded: with n sensors in the
/// frame at most 5 + 2 n fits of at most 1 + 9 max_iterations rod solutions (usually one fit of three). One object a
/// catheter and a thread.
class ForceObserver {
 public:
  /// Throws InputError where catheter or options are not usable.
  ForceObserver(const Catheter& catheter, const ObserverOptions& options);

  /// Frames in time order; `frame.readings` as Catheter::sensors (a tracked base last).
  Estimate update(const TrackerFrame& frame);

 private:
  /// The shape model with its noise as adapted so far.
  struct AdaptedModel {
    ShapeModel& shape;
    const NoiseAdaptation* adaptation;
    int rows() const { return shape.rows(); }
    void noise(ResidualMatrix& R) const;
    bool linearize(const StateVector& x, Linearization& at) { return shape.linearize(x, at); }
  };

  void predict(double dt_s);
  EstimateStatus explain_frame();
  EstimateStatus explain_surprise(unsigned present);
  EstimateStatus explain_without_one_sensor(unsigned present, const Gaussian& anywhere);
  bool fit(unsigned sensors, const Gaussian& prior, const StateVector& start);
  bool agrees_with_prediction() const;
  bool explains_sensors() const;
  bool agrees_with_itself() const;
  void single_step(const Gaussian& prior);
  EstimateStatus accept(const Gaussian& prior);
  EstimateStatus take(const Gaussian& prior);
  Estimate report(double time_s, FrameTime time, EstimateStatus status) const;

  Catheter catheter_;
  ObserverOptions options_;
  ChiSquareGate gate_;
  FrameClock clock_;
  ShapeModel shape_;
  std::optional<NoiseAdaptation> adaptation_;

  Gaussian state_;  ///< posterior; after predict() the prior of the frame at hand
  Matrix3d R_base_tip_;
  Measurement measurement_;
  Update update_;  ///< latest fit of the frame at hand
  unsigned used_ = 0;
  std::int64_t evaluations_before_ = 0;
  ConvergenceIndex convergence_;
};

}  // namespace palpate
