// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/math/errors.hpp>
#include <palpate/observer/options.hpp>

namespace palpate {
namespace {

template <typename Change>
std::string error_after(const Change& change) {
  ObserverOptions options;
  change(options);
  try {
    options.validate();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ObserverOptions, DefaultsAreValid) {
  EXPECT_EQ(error_after([](ObserverOptions&) {}), "no error");
}

TEST(ObserverOptions, ValidateNamesFieldValueAndRange) {
  EXPECT_EQ(error_after([](ObserverOptions& o) { o.force_rate_N_per_sqrt_s = -1.0; }),
            "observer options: force_rate_N_per_sqrt_s = -1: expected 0 (found from the data), or at most 100");
  EXPECT_EQ(error_after([](ObserverOptions& o) { o.force_rate_N_per_sqrt_s = 0.1; }),
            "observer options: force_rate_N_per_sqrt_s = 0.1: expected 0 (found from the data) for every force_model "
            "but random_walk");
  EXPECT_EQ(error_after([](ObserverOptions& o) {
              o.force_model = ForceMotion::kRandomWalk;
              o.force_acceleration_N_per_s_sqrt_s = 2.0;
            }),
            "observer options: force_acceleration_N_per_s_sqrt_s = 2: expected 0 (found from the data) for every "
            "force_model but constant_velocity and rhythm");
  EXPECT_EQ(error_after([](ObserverOptions& o) { o.jump_probability = 0.0; }),
            "observer options: jump_probability = 0: expected more than 0, at most 0.1");
  EXPECT_EQ(error_after([](ObserverOptions& o) { o.noise_tail_degrees = 0.5; }),
            "observer options: noise_tail_degrees = 0.5: expected 0 (Gaussian) or 1..100");
  EXPECT_EQ(error_after([](ObserverOptions& o) { o.disturbance_rms_N = std::nan(""); }),
            "observer options: disturbance_rms_N = nan: expected 0 (none) to 1000");
  EXPECT_EQ(error_after([](ObserverOptions& o) { o.disturbance_memory_s = 0.0; }),
            "observer options: disturbance_memory_s = 0: expected 0.001..10000");
  EXPECT_EQ(error_after([](ObserverOptions& o) { o.stiffness_drift_per_sqrt_s = 0.0; }),
            "observer options: stiffness_drift_per_sqrt_s = 0: expected more than 0, at most 10");
  EXPECT_EQ(error_after([](ObserverOptions& o) { o.precurvature_drift_per_m_sqrt_s = std::nan(""); }),
            "observer options: precurvature_drift_per_m_sqrt_s = nan: expected more than 0, at most 1000");
  EXPECT_EQ(error_after([](ObserverOptions& o) { o.forecast_s = 61.0; }),
            "observer options: forecast_s = 61: expected 0..60");
  EXPECT_EQ(error_after([](ObserverOptions& o) { o.smoothing_lag_frames = -1; }),
            "observer options: smoothing_lag_frames = -1: expected 0..1000");
  EXPECT_EQ(error_after([](ObserverOptions& o) { o.initial_force_sigma_N = std::nan(""); }),
            "observer options: initial_force_sigma_N = nan: expected more than 0, at most 1000");
  EXPECT_EQ(error_after([](ObserverOptions& o) { o.max_iterations = 0; }),
            "observer options: max_iterations = 0: expected 1..100");
  EXPECT_EQ(error_after([](ObserverOptions& o) { o.adaptation_window = 1001; }),
            "observer options: adaptation_window = 1001: expected 5..1000");
  EXPECT_EQ(error_after([](ObserverOptions& o) { o.outlier_probability = 0.2; }),
            "observer options: outlier_probability = 0.2: expected more than 0, at most 0.1");
}

}  // namespace
}  // namespace palpate
