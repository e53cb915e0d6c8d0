// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/math/errors.hpp>
#include <palpate/observer/options.hpp>

namespace palpate {
namespace {

void require(bool good, const char* field, double value, const char* range) {
  if (good) return;
  throw InputError(fmt::format("observer options: {} = {}: expected {}", field, value, range));
}

}  // namespace

MotionOptions ObserverOptions::motion() const {
  MotionOptions motion{.motion = force_model, .force_memory_s = force_memory_s, .force_sigma_N = initial_force_sigma_N};
  motion.disturbance_rms_N.setConstant(disturbance_rms_N);
  motion.disturbance_memory_s = disturbance_memory_s;
  return motion;
}

ParameterChoice ObserverOptions::parameters() const {
  return {.consider = consider_uncertainty,
          .estimate_stiffness = estimate_stiffness,
          .free_torsion = free_torsion,
          .estimate_precurvature = estimate_precurvature,
          .stiffness_rate_per_s = stiffness_rate_per_s,
          .stiffness_drift_per_sqrt_s = stiffness_drift_per_sqrt_s,
          .precurvature_drift_per_m_sqrt_s = precurvature_drift_per_m_sqrt_s};
}

double ObserverOptions::stated_drive() const {
  if (force_model == ForceMotion::kRandomWalk) return force_rate_N_per_sqrt_s;
  return force_model == ForceMotion::kGaussMarkov ? 0.0 : force_acceleration_N_per_s_sqrt_s;
}

void ObserverOptions::validate() const {
  if (force_model > ForceMotion::kRhythm)
    throw InputError("observer options: force_model: expected one of ForceMotion");
  require(force_rate_N_per_sqrt_s >= 0.0 && force_rate_N_per_sqrt_s <= 100.0, "force_rate_N_per_sqrt_s",
          force_rate_N_per_sqrt_s, "0 (found from the data), or at most 100");
  require(force_rate_N_per_sqrt_s == 0.0 || force_model == ForceMotion::kRandomWalk, "force_rate_N_per_sqrt_s",
          force_rate_N_per_sqrt_s, "0 (found from the data) for every force_model but random_walk");
  require(force_acceleration_N_per_s_sqrt_s >= 0.0 && force_acceleration_N_per_s_sqrt_s <= 1000.0,
          "force_acceleration_N_per_s_sqrt_s", force_acceleration_N_per_s_sqrt_s,
          "0 (found from the data), or at most 1000");
  require(force_acceleration_N_per_s_sqrt_s == 0.0 || force_model == ForceMotion::kConstantVelocity ||
              force_model == ForceMotion::kRhythm,
          "force_acceleration_N_per_s_sqrt_s", force_acceleration_N_per_s_sqrt_s,
          "0 (found from the data) for every force_model but constant_velocity and rhythm");
  require(force_memory_s >= 1e-3 && force_memory_s <= 1e4, "force_memory_s", force_memory_s, "0.001..10000");
  require(initial_force_sigma_N > 0.0 && initial_force_sigma_N <= 1000.0, "initial_force_sigma_N",
          initial_force_sigma_N, "more than 0, at most 1000");
  require(max_iterations >= 1 && max_iterations <= 100, "max_iterations", max_iterations, "1..100");
  require(adaptation_window >= 5 && adaptation_window <= 1000, "adaptation_window", adaptation_window, "5..1000");
  require(outlier_probability > 0.0 && outlier_probability <= 0.1, "outlier_probability", outlier_probability,
          "more than 0, at most 0.1");
  require(jump_probability > 0.0 && jump_probability <= 0.1, "jump_probability", jump_probability,
          "more than 0, at most 0.1");
  require(noise_tail_degrees == 0.0 || (noise_tail_degrees >= 1.0 && noise_tail_degrees <= 100.0), "noise_tail_degrees",
          noise_tail_degrees, "0 (Gaussian) or 1..100");
  require(disturbance_rms_N >= 0.0 && disturbance_rms_N <= 1000.0, "disturbance_rms_N", disturbance_rms_N,
          "0 (none) to 1000");
  require(disturbance_memory_s >= 1e-3 && disturbance_memory_s <= 1e4, "disturbance_memory_s", disturbance_memory_s,
          "0.001..10000");
  require(stiffness_rate_per_s > 0.0 && stiffness_rate_per_s <= 10.0, "stiffness_rate_per_s", stiffness_rate_per_s,
          "more than 0, at most 10");
  require(stiffness_drift_per_sqrt_s > 0.0 && stiffness_drift_per_sqrt_s <= 10.0, "stiffness_drift_per_sqrt_s",
          stiffness_drift_per_sqrt_s, "more than 0, at most 10");
  require(precurvature_drift_per_m_sqrt_s > 0.0 && precurvature_drift_per_m_sqrt_s <= 1000.0,
          "precurvature_drift_per_m_sqrt_s", precurvature_drift_per_m_sqrt_s, "more than 0, at most 1000");
  require(forecast_s >= 0.0 && forecast_s <= 60.0, "forecast_s", forecast_s, "0..60");
  require(smoothing_lag_frames >= 0 && smoothing_lag_frames <= 1000, "smoothing_lag_frames", smoothing_lag_frames,
          "0..1000");
}

}  // namespace palpate
