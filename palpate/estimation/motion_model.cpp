// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <palpate/estimation/motion_model.hpp>
#include <palpate/math/errors.hpp>
#include <string>

namespace palpate {
namespace {

constexpr int kLevel = 0, kRate = 1;

/// An oscillator without amplitude keeps this much, so that covariances stay definite: far below any sensor's grain.
constexpr double kLeastSpread_N = 1e-5;

void require(bool good, const char* field, double value, const char* range) {
  if (good) return;
  throw InputError("motion options: " + std::string(field) + " = " + std::to_string(value) + ": expected " + range);
}

double oscillator_rad_per_s(const MotionOptions& options, const Rhythm& rhythm, int k) {
  const bool heart = k < options.heart_harmonics;
  const int harmonic = 1 + (heart ? k : k - options.heart_harmonics);
  return 2.0 * std::numbers::pi * harmonic * (heart ? rhythm.heart_Hz : rhythm.breathing_Hz);
}

const Vector3d& oscillator_sigma_N(const MotionOptions& options, const Rhythm& rhythm, int k) {
  return k < options.heart_harmonics ? rhythm.heart_sigma_N[static_cast<std::size_t>(k)]
                                     : rhythm.breathing_sigma_N[static_cast<std::size_t>(k - options.heart_harmonics)];
}

}  // namespace

FadingRate::FadingRate(double dt_s, double memory_s) {
  const double u = dt_s / memory_s, dt = dt_s;
  keep = std::exp(-u);
  // For small u the closed form of the first variance cancels to nothing: series of integral (1 - e^-s)^2 ds.
  if (u < 0.02) {
    travel_s = dt * (1.0 - u / 2.0 + u * u / 6.0 - u * u * u / 24.0 + u * u * u * u / 120.0);
    variance(0) = dt * dt * dt * (1.0 / 3.0 - u / 4.0 + 7.0 * u * u / 60.0 - u * u * u / 24.0);
    variance(2) = u == 0.0 ? dt : -0.5 * memory_s * std::expm1(-2.0 * u);
  } else {
    const double lost = -std::expm1(-u), lost2 = -std::expm1(-2.0 * u);
    travel_s = memory_s * lost;
    variance(0) = memory_s * memory_s * memory_s * (u - 2.0 * lost + 0.5 * lost2);
    variance(2) = 0.5 * memory_s * lost2;
  }
  variance(1) = 0.5 * travel_s * travel_s;
}

void MotionOptions::validate() const {
  require(rate_memory_s >= 0.01, "rate_memory_s", rate_memory_s, "at least 0.01");
  require(force_memory_s >= 1e-3 && force_memory_s <= 1e4, "force_memory_s", force_memory_s, "0.001..10000");
  require(force_sigma_N > 0.0 && force_sigma_N <= 1000.0, "force_sigma_N", force_sigma_N, "more than 0, at most 1000");
  require(rate_sigma_N_per_s > 0.0 && rate_sigma_N_per_s <= 1e5, "rate_sigma_N_per_s", rate_sigma_N_per_s,
          "more than 0, at most 1e5");
  require(heart_harmonics >= 1 && heart_harmonics <= kMaxHeartHarmonics, "heart_harmonics", heart_harmonics, "1..3");
  require(breathing_harmonics >= 0 && breathing_harmonics <= kMaxBreathingHarmonics, "breathing_harmonics",
          breathing_harmonics, "0..2");
  require(rhythm_memory_s >= 0.1 && rhythm_memory_s <= 1e4, "rhythm_memory_s", rhythm_memory_s, "0.1..10000");
  for (int i = 0; i < 3; ++i)
    require(disturbance_rms_N(i) >= 0.0 && disturbance_rms_N(i) <= 1000.0, "disturbance_rms_N", disturbance_rms_N(i),
            "0..1000");
  require(disturbance_memory_s >= 1e-3 && disturbance_memory_s <= 1e4, "disturbance_memory_s", disturbance_memory_s,
          "0.001..10000");
}

MotionModel::MotionModel(const MotionOptions& options) : options_(options) {
  options_.validate();
  has_rate_ = options.motion == ForceMotion::kConstantVelocity || options.motion == ForceMotion::kRhythm;
  has_disturbance_ = options.disturbance_rms_N.maxCoeff() > 0.0;
  oscillators_ = options.motion == ForceMotion::kRhythm ? options.heart_harmonics + options.breathing_harmonics : 0;
  first_oscillator_ = has_rate_ ? 2 : 1;
  components_ = first_oscillator_ + 2 * oscillators_ + (has_disturbance_ ? 1 : 0);

  oscillating_.setZero(components_);
  for (int k = 0; k < oscillators_; ++k) oscillating_(first_oscillator_ + 2 * k) = 1.0;
  reported_ = oscillating_;
  reported_(kLevel) = 1.0;
  seen_ = reported_;
  if (has_disturbance_) seen_(components_ - 1) = 1.0;
}

void MotionModel::initial(MotionState& state) const {
  state.mean.setZero(states());
  state.covariance.setZero(states(), states());
  auto variance = state.covariance.diagonal();
  variance.segment<3>(3 * kLevel).setConstant(options_.force_sigma_N * options_.force_sigma_N);
  if (has_rate_) variance.segment<3>(3 * kRate).setConstant(options_.rate_sigma_N_per_s * options_.rate_sigma_N_per_s);
  variance.segment(3 * first_oscillator_, 6 * oscillators_).setConstant(kLeastSpread_N * kLeastSpread_N);
  if (has_disturbance_) variance.tail<3>() = options_.disturbance_rms_N.cwiseAbs2();
}

void MotionModel::transition(const MotionStep& step, ComponentMatrix& a) const {
  a.setIdentity(components_, components_);
  if (options_.motion == ForceMotion::kGaussMarkov) a(kLevel, kLevel) = std::exp(-step.dt_s / options_.force_memory_s);
  if (has_rate_) {
    const FadingRate fading(step.dt_s, options_.rate_memory_s);
    a(kLevel, kRate) = fading.travel_s;
    a(kRate, kRate) = fading.keep;
  }
  const double keep = std::exp(-step.dt_s / options_.rhythm_memory_s);
  for (int k = 0; k < oscillators_; ++k) {
    const int u = first_oscillator_ + 2 * k, v = u + 1;
    const double angle = oscillator_rad_per_s(options_, step.rhythm, k) * step.dt_s;
    a(u, u) = a(v, v) = keep * std::cos(angle);
    a(u, v) = keep * std::sin(angle);
    a(v, u) = -a(u, v);
  }
  if (has_disturbance_) a(components_ - 1, components_ - 1) = std::exp(-step.dt_s / options_.disturbance_memory_s);
}

void MotionModel::add_level_noise(const MotionStep& step, MotionMatrix& P) const {
  auto variance = P.diagonal();
  const Vector3d drive2 = step.drive.cwiseAbs2();
  if (has_rate_) {
    const FadingRate fading(step.dt_s, options_.rate_memory_s);
    variance.segment<3>(3 * kLevel) += fading.variance(0) * drive2;
    variance.segment<3>(3 * kRate) += fading.variance(2) * drive2;
    for (int i = 0; i < 3; ++i) {
      P(3 * kLevel + i, 3 * kRate + i) += fading.variance(1) * drive2(i);
      P(3 * kRate + i, 3 * kLevel + i) += fading.variance(1) * drive2(i);
    }
  } else if (options_.motion == ForceMotion::kGaussMarkov) {
    const double lost = -std::expm1(-2.0 * step.dt_s / options_.force_memory_s);
    variance.segment<3>(3 * kLevel).array() += lost * options_.force_sigma_N * options_.force_sigma_N;
  } else {
    variance.segment<3>(3 * kLevel) += step.dt_s * drive2;
  }
  if (!step.jump) return;
  variance.segment<3>(3 * kLevel).array() += options_.force_sigma_N * options_.force_sigma_N;
  if (has_rate_) variance.segment<3>(3 * kRate).array() += options_.rate_sigma_N_per_s * options_.rate_sigma_N_per_s;
}

void MotionModel::add_noise(const MotionStep& step, MotionMatrix& P) const {
  add_level_noise(step, P);
  auto variance = P.diagonal();
  const double lost = -std::expm1(-2.0 * step.dt_s / options_.rhythm_memory_s);
  for (int k = 0; k < oscillators_; ++k) {
    const Vector3d sigma = oscillator_sigma_N(options_, step.rhythm, k).cwiseMax(kLeastSpread_N);
    variance.segment<3>(3 * (first_oscillator_ + 2 * k)) += lost * sigma.cwiseAbs2();
    variance.segment<3>(3 * (first_oscillator_ + 2 * k + 1)) += lost * sigma.cwiseAbs2();
  }
  if (!has_disturbance_) return;
  const double forgotten = -std::expm1(-2.0 * step.dt_s / options_.disturbance_memory_s);
  variance.tail<3>() += forgotten * options_.disturbance_rms_N.cwiseAbs2();
}

void MotionModel::predict(const MotionStep& step, MotionState& state) const {
  ComponentMatrix a;
  transition(step, a);
  apply_transition(a, state.mean);
  apply_transition(a, state.covariance);
  state.covariance.transposeInPlace();
  apply_transition(a, state.covariance);
  add_noise(step, state.covariance);
}

ForceGaussian MotionModel::forecast(const MotionStep& step, const MotionState& state) const {
  MotionState ahead = state;
  predict(step, ahead);
  return force_of(reported_, ahead);
}

}  // namespace palpate
