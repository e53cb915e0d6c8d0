// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/estimation/motion_model.hpp>
#include <palpate/estimation/process_noise.hpp>
#include <palpate/estimation/rhythm.hpp>

namespace palpate {

/// The hidden state of a moving force between the frames, with process noise and rhythm found by itself. Whoever knows
/// the sensors updates the three-dimensional seen force; this does the rest, exactly:
///
///   prior = predict(dt);                              N(H x-, H P- H^T)
///   posterior = [nonlinear update of prior];          three unknowns, any method
///   absorb(likelihood_between(prior, posterior));     or hold(), where the frame was of no use
///   reported(), forecast(ahead)
///
/// absorb() first lets the frame tune the process noise, then repeats the prediction with it: the step that led to a
/// frame is judged by the frame, so that a sudden movement finds the covariance already open. No call but the
/// constructor allocates or throws; about 3 us a frame with constant velocity, 20 us with rhythm.
class MotionFilter {
 public:
  /// Process noise adapted from the data. Throws InputError where the options are not usable.
  MotionFilter(const MotionOptions& motion, const ProcessNoiseOptions& noise);
  /// Process noise fixed: `drive` a tip axis, unit as MotionStep::drive.
  MotionFilter(const MotionOptions& motion, const Vector3d& drive);

  /// The next frame lies dt_s later (0 for the first). Returns the prior of the seen force.
  const ForceGaussian& predict(double dt_s);
  const ForceGaussian& prior() const { return prior_; }
  /// Prior of the frame at hand if the force has jumped: force_sigma^2 wider.
  ForceGaussian prior_after_jump() const;

  /// What the frame at hand says. `jump`: it was explained from prior_after_jump(). False, and the frame counts as
  /// held, where a covariance has lost its definiteness.
  bool absorb(const ForceLikelihood& likelihood, bool jump);
  /// The frame at hand says nothing.
  void hold();

  ForceGaussian seen() const { return force_of(model_.seen(), state_); }
  ForceGaussian reported() const { return force_of(model_.reported(), state_); }
  /// The force of the tissue `ahead_s` after the latest frame.
  ForceGaussian forecast(double ahead_s) const;

  const MotionModel& model() const { return model_; }
  const MotionState& state() const { return state_; }
  /// Of the latest frame, for the smoothers: its step and what it did.
  const MotionStep& step() const { return step_; }
  const ForceCorrection& correction() const { return correction_; }
  const Vector3d& drive() const { return step_.drive; }
  const RhythmTracker& rhythm() const { return rhythm_; }

 private:
  void repeat_prediction();
  bool correct(const ForceGaussian& posterior);
  double belief_N() const;

  MotionModel model_;
  ProcessNoise noise_;
  bool adapts_ = true;
  RhythmTracker rhythm_;
  MotionStep step_;
  MotionState before_, state_;  ///< after the frame before; after prediction and then update of the frame at hand
  ForceGaussian prior_;
  ForceCorrection correction_;
};

}  // namespace palpate
