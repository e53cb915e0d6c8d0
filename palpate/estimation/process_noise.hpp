// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <palpate/estimation/motion_model.hpp>

namespace palpate {

/// Of the process noise's adaptation. Two sets of limits, by the law of motion: ProcessNoiseOptions::of().
struct ProcessNoiseOptions {
  double least_drive = 5e-4;    ///< q cannot fall lower; unit as MotionStep::drive
  double largest_drive = 50.0;  ///< nor rise higher
  double prior_drive = 1.0;     ///< the guess before any frame, and after a change of regime
  double prior_spread = 1.5;    ///< its standard deviation, in ln q
  double drift_per_s = 0.5;     ///< how often q moves to its neighbour on the grid (a factor of about 2)
  double change_per_s = 0.03;   ///< how often it becomes anything: the force starts to move after a rest

  static ProcessNoiseOptions of(ForceMotion motion);
  /// Throws InputError naming the field, its value and the range.
  void validate() const;
};

/// Finds the process noise q of every tip axis from the data, by a bank of filters. On each axis kGrid filters of the
/// same law of motion, each with its own q on a logarithmic grid, follow the frames; their predictions' likelihoods
/// weigh them, and q itself may change as a Markov chain (to a neighbour, or, seldom, to anything):
///
///   w_g <- sum_h T_gh w_h (predict),   w_g <- w_g N(z - F_g; 0, P_g + R_ii) (observe),   q^2 = sum_g w_g q_g^2
///
/// z and R: the frame's own estimate of the force and its covariance, so that the bank does not depend on the filter it
/// tunes and cannot be drawn along by its errors. R_ii is the marginal variance: what an axis knows only through the
/// others counts as unknown. The mean of q^2 is the process noise of the mixture: too large a covariance rather than
/// too small while q is uncertain. Neither allocates nor throws after construction; 3 kGrid filters of three states,
/// about 2 us a frame.
class ProcessNoise {
 public:
  static constexpr int kGrid = 16;

  /// Adapts the drive of `model`'s level. Throws InputError where the options are not usable.
  ProcessNoise(const MotionModel& model, const ProcessNoiseOptions& options);

  /// Time passes, with or without a frame to follow. dt_s >= 0.
  void predict(double dt_s);

  /// The observer has found a jump in the frame at hand (before observe()): the filters are as open to anything as the
  /// motion model is, so that it says nothing about q.
  void jump();

  /// The frame at hand. `explained`: the share of the seen force that others have predicted (the rhythm's oscillators),
  /// taken off the measurement and its variance added. Unusable or empty likelihoods are passed over.
  void observe(const ForceLikelihood& likelihood, const ForceGaussian& explained);

  /// sqrt(E[q^2]) a tip axis; unit as MotionStep::drive.
  Vector3d drive() const { return drive_ahead(0.0); }
  /// The same, of a time to come: sqrt(E[q^2]) after ahead_s without a frame.
  Vector3d drive_ahead(double ahead_s) const;

 private:
  using Weights = std::array<double, kGrid>;
  /// Level x, rate v, disturbance d of one axis: means, and P by its entries, an array over the grid each, so that the
  /// filters run side by side in SIMD lanes. What the model lacks stays zero.
  struct Axis {
    Weights x{}, v{}, d{};
    Weights xx{}, xv{}, vv{}, xd{}, vd{}, dd{};
    Weights weight{};
  };

  void restart(int axis, std::size_t g, Axis& out) const;
  void mix_weights(double dt_s, Weights& weight) const;
  void observe_axis(double z_N, double variance_N2, Axis& axis) const;

  MotionOptions motion_;
  ProcessNoiseOptions options_;
  bool has_rate_ = false;
  Weights grid_{}, prior_weight_{};
  std::array<Axis, 3> axes_;
};

}  // namespace palpate
