// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <palpate/estimation/motion_state.hpp>

namespace palpate {

/// The law by which the force moves between frames.
enum class ForceMotion {
  kRandomWalk,        ///< anywhere, given time: the paper's (10)
  kConstantVelocity,  ///< force and its rate; the rate is driven by white noise and fades
  kGaussMarkov,       ///< about zero with a known spread
  kRhythm,            ///< constant velocity plus harmonics of heart and breathing
};

/// Of the law of motion, not of the data: the drive comes from ProcessNoise, the frequencies from RhythmTracker.
struct MotionOptions {
  ForceMotion motion = ForceMotion::kConstantVelocity;
  double rate_memory_s = 1.0;       ///< the rate fades with this time; range [0.01, inf]; inf: constant velocity proper
  double force_memory_s = 1.0;      ///< Gauss-Markov: correlation time; range [1e-3, 1e4]
  double force_sigma_N = 0.3;       ///< before the first frame, added at a jump, Gauss-Markov's spread; range (0, 1000]
  double rate_sigma_N_per_s = 1.0;  ///< of the rate, before the first frame and added at a jump; range (0, 1e5]
  int heart_harmonics = 3;          ///< range [1, 3]
  int breathing_harmonics = 2;      ///< range [0, 2]
  double rhythm_memory_s = 5.0;     ///< an oscillation forgets amplitude and phase in this time; range [0.1, 1e4]
  Vector3d disturbance_rms_N = Vector3d::Zero();  ///< flowing blood: seen, not reported; 0: none; range [0, 1000]
  double disturbance_memory_s = 0.1;              ///< its correlation time; range [1e-3, 1e4]

  /// Throws InputError naming the field, its value and the range.
  void validate() const;
};

/// Frequencies, and how strong each oscillation is on each axis. Oscillators: the heart's harmonics, then breathing's.
struct Rhythm {
  double heart_Hz = 1.2;
  double breathing_Hz = 0.25;
  std::array<Vector3d, kMaxHeartHarmonics> heart_sigma_N{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  std::array<Vector3d, kMaxBreathingHarmonics> breathing_sigma_N{Vector3d::Zero(), Vector3d::Zero()};
};

/// All that a prediction depends on, besides the state: enough to repeat it later (smoothing).
struct MotionStep {
  double dt_s = 0.0;
  Vector3d drive = Vector3d::Zero();  ///< q a tip axis: N/sqrt(s) (random walk), N/s^1.5 (velocity, rhythm)
  bool jump = false;                  ///< the force has become anything: force_sigma_N, rate_sigma_N_per_s are added
  Rhythm rhythm;
};

/// x- = A x+, P- = A P+ A^T + Q. The sensors see H x; the force of the tissue is C x, without the disturbance:
///
///   random walk         level' = w,  E(w w) = q^2                                                       (10)
///   constant velocity   level' = rate,  rate' = -rate / tau + w
///   Gauss-Markov        level' = -level / T + w, of spread force_sigma
///   rhythm              constant velocity, and pairs (u, v) turning at omega: u' = omega v - u / T, v' = -omega u - v
///   / T,
///                       each driven so that its spread is the sigma of the step
///   disturbance         d' = -d / T_d + w, of spread disturbance_rms
///
/// all solved exactly over dt, and alike on every axis but for the noise. Immutable; the calls neither allocate nor
/// throw. predict() costs about 12 n^2 products, n = states().
class MotionModel {
 public:
  /// Throws InputError where the options are not usable.
  explicit MotionModel(const MotionOptions& options);

  int components() const { return components_; }
  int states() const { return 3 * components_; }
  const MotionOptions& options() const { return options_; }
  const ComponentRow& seen() const { return seen_; }          ///< H: F_seen = (H x I3) x
  const ComponentRow& reported() const { return reported_; }  ///< C: F = (C x I3) x
  bool has_rate() const { return has_rate_; }
  /// The oscillators' part of the force: seen, but not of level, rate or disturbance.
  const ComponentRow& oscillating() const { return oscillating_; }

  /// Before the first frame: level N(0, force_sigma^2), rate N(0, rate_sigma^2), oscillators still, the disturbance at
  /// its spread.
  void initial(MotionState& state) const;

  void predict(const MotionStep& step, MotionState& state) const;

  /// A = (a x I3), a: components x components.
  void transition(const MotionStep& step, ComponentMatrix& a) const;
  /// P <- P + Q.
  void add_noise(const MotionStep& step, MotionMatrix& P) const;

  /// The force of the tissue `step.dt_s` ahead, with its covariance; n steps ahead: dt = n frames.
  ForceGaussian forecast(const MotionStep& step, const MotionState& state) const;

 private:
  void add_level_noise(const MotionStep& step, MotionMatrix& P) const;

  MotionOptions options_;
  bool has_rate_ = false, has_disturbance_ = false;
  int oscillators_ = 0, first_oscillator_ = 0, components_ = 1;
  ComponentRow seen_, reported_, oscillating_;
};

/// M <- (a x I3) M, of any number of columns. Skips the zeros of a.
template <class M>
void apply_transition(const ComponentMatrix& a, M& columns) {
  const M before = columns;
  columns.setZero();
  for (Eigen::Index r = 0; r < a.rows(); ++r)
    for (Eigen::Index c = 0; c < a.cols(); ++c)
      if (a(r, c) != 0.0) columns.template middleRows<3>(3 * r) += a(r, c) * before.template middleRows<3>(3 * c);
}

/// Level and rate over dt with the rate fading: level += travel rate, rate *= keep; noise q^2 times `variance`
/// [level-level, level-rate, rate-rate]. memory = inf: keep 1, travel dt, variances dt^3/3, dt^2/2, dt.
struct FadingRate {
  FadingRate(double dt_s, double memory_s);
  double keep, travel_s;
  Vector3d variance;  ///< s^3, s^2, s
};

}  // namespace palpate
