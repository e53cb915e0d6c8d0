// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <palpate/estimation/belief.hpp>
#include <palpate/estimation/process_noise.hpp>
#include <palpate/estimation/rhythm.hpp>

namespace palpate {

/// The hidden state of a moving force between the frames, and the uncertain parameters of the sensors' model, with
/// process noise and rhythm found by itself. Whoever knows the sensors solves for force and parameters, by any method,
/// and hands back the straight line that the frame comes to; this does the rest, exactly:
///
///   prior = predict(dt);                    N of (F, p): H x-, p-
///   line = [nonlinear update of prior];
///   absorb(line, jump);                     or hold(), where the frame was of no use
///   reported(), forecast(ahead), parameters
///
/// absorb() first lets the frame tune the process noise, then repeats the prediction with it: the step that led to a
/// frame is judged by the frame, so that a sudden movement finds the covariance already open. No call but the
/// constructor allocates or throws; a few us a frame with constant velocity, 20 us with rhythm, without parameters.
class MotionFilter {
 public:
  /// Process noise adapted from the data. Throws InputError where the options are not usable.
  MotionFilter(const MotionOptions& motion, const ProcessNoiseOptions& noise, const ParameterPrior& parameters = {});
  /// Process noise fixed: `drive` a tip axis, unit as MotionStep::drive.
  MotionFilter(const MotionOptions& motion, const Vector3d& drive, const ParameterPrior& parameters = {});

  /// Of a parameter that is drawn anew at every frame: its sigma from the next prediction on.
  void set_sigma(Eigen::Index parameter, double sigma) { parameters_.set_sigma(parameter, sigma); }

  /// From when on a frame counts as blind to the axial force (hide_axial_force); none by default.
  void set_weak_force(double weak_N) { weak_force_N_ = weak_N; }

  /// The next frame lies dt_s later (0 for the first). Returns the prior of the seen force.
  const ForceGaussian& predict(double dt_s);
  const ForceGaussian& prior() const { return prior_; }
  /// The same with the parameters.
  const SeenBelief& seen_prior() const { return seen_; }
  /// Prior of the frame at hand if the force has jumped: force_sigma^2 wider.
  ForceGaussian prior_after_jump() const;

  /// What the frame at hand says. `jump`: it was explained from a prior that much wider. False, and the frame counts as
  /// held, where a covariance has lost its definiteness.
  bool absorb(const FrameLine& line, bool jump);
  /// The same of a frame that speaks of the force alone.
  bool absorb(const ForceLikelihood& likelihood, bool jump);
  /// The frame at hand says nothing.
  void hold();

  /// f, as the model of motion follows it (ParameterPrior::force_exponents).
  ForceGaussian seen() const { return force_of(model_.seen(), belief_.motion); }
  /// The force of the tissue, F.
  ForceGaussian reported() const { return newtons(belief_); }
  /// The force of the tissue `ahead_s` after the latest frame.
  ForceGaussian forecast(double ahead_s) const;

  const MotionModel& model() const { return model_; }
  const BeliefModel& parameters() const { return parameters_; }
  const Belief& belief() const { return belief_; }
  const MotionState& state() const { return belief_.motion; }
  /// Of the latest frame, for the smoothers: its step and what it did.
  const MotionStep& step() const { return step_; }
  const Correction& correction() const { return correction_; }
  const Vector3d& drive() const { return step_.drive; }
  const RhythmTracker& rhythm() const { return rhythm_; }

 private:
  ForceGaussian newtons(const Belief& belief) const;
  void repeat_prediction();
  bool correct();
  bool tune_and_correct(const ForceLikelihood& likelihood, bool jump);
  double belief_N() const;

  MotionModel model_;
  BeliefModel parameters_;
  ProcessNoise noise_;
  bool adapts_ = true;
  RhythmTracker rhythm_;
  MotionStep step_;
  Belief before_, belief_;  ///< after the frame before; after prediction and then update of the frame at hand
  mutable Belief ahead_;    ///< work space of forecast()
  SeenBelief seen_;
  ForceGaussian prior_;
  double weak_force_N_ = std::numeric_limits<double>::infinity();
  bool axial_hidden_ = false;  ///< from the latest frame that was absorbed
  bool limited_ = false;       ///< the prior is narrower than the prediction, for no such force is believed
  FrameLine line_;
  Correction correction_;
};

}  // namespace palpate
