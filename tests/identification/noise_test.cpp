// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <palpate/identification/noise.hpp>
#include <palpate/identification/noise_statistics.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <tests/random_draws.hpp>
#include <tests/shared_data.hpp>

namespace palpate {
namespace {

using test::Draws;

double rounded(double value, double step) { return step > 0.0 ? step * std::round(value / step) : value; }

/// A tracker that looks at a sensor standing still: what it says is known because it is made here.
struct VirtualRest {
  Vector3d sigma_m{20e-6, 30e-6, 60e-6};  ///< along tracker axes
  Vector3d sigma_rad{0.6e-3, 0.9e-3, 1.5e-3};
  double step_m = 0.0, step_q = 0.0;  ///< quantisation
  double repeat_share = 0.0;          ///< of rows that repeat the one before
  double drift_m_per_s = 0.0;
  double period_s = 0.025;

  std::vector<TrackerFrame> frames(std::size_t count, unsigned seed) const {
    Draws draws(seed);
    const Pose truth{draws.rotation(), draws.in_ball(0.2)};
    std::vector<TrackerFrame> frames(count);
    for (std::size_t i = 0; i < count; ++i) {
      frames[i].time_s = period_s * static_cast<double>(i);
      frames[i].readings = {i > 0 && draws.uniform(0.0, 1.0) < repeat_share ? frames[i - 1].readings[0]
                                                                            : reading(truth, frames[i].time_s, draws)};
    }
    return frames;
  }

 private:
  SensorReading reading(const Pose& truth, double time_s, Draws& draws) const {
    SensorReading r;
    r.status = SensorReading::Status::kOk;
    r.has_orientation = true;
    r.position_m = truth.p + sigma_m.cwiseProduct(draws.normal3()) + Vector3d::Constant(drift_m_per_s * time_s);
    for (double& x : r.position_m) x = rounded(x, step_m);
    const Matrix3d R = truth.R * Draws::turn(sigma_rad.cwiseProduct(draws.normal3()));
    Eigen::Quaterniond q(R);
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    r.quaternion_wxyz << rounded(q.w(), step_q), rounded(q.x(), step_q), rounded(q.y(), step_q), rounded(q.z(), step_q);
    return r;
  }
};

RestNoise rest_noise(const VirtualRest& rest, std::size_t count, unsigned seed) {
  return identify_rest_noise(collect_samples(rest.frames(count, seed), 0));
}

bool positive_definite(const Matrix6d& m) { return Eigen::LLT<Matrix6d>(m).info() == Eigen::Success; }

/// Over seeds: the sigmas come back, and differ from the truth by as much as is said of them.
void expect_honest(const VirtualRest& rest, double extra_variance_m2 = 0.0) {
  double squares = 0.0, bias = 0.0;
  constexpr int kSeeds = 40;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const RestNoise noise = rest_noise(rest, 800, seed);
    EXPECT_TRUE(positive_definite(noise.covariance));
    EXPECT_EQ(noise.rest, Rest::kStill);
    for (int axis = 0; axis < 6; ++axis) {
      const double true_sigma =
          axis < 3 ? std::sqrt(rest.sigma_m(axis) * rest.sigma_m(axis) + extra_variance_m2) : rest.sigma_rad(axis - 3);
      const double miss = std::sqrt(noise.covariance(axis, axis)) / true_sigma - 1.0;
      squares += std::pow(miss / noise.sigma_fraction, 2) / (6.0 * kSeeds);
      bias += miss / (6.0 * kSeeds);
    }
  }
  // sigma_fraction is that of the slowest channel: a little too large for the others.
  EXPECT_GT(squares, 0.4);
  EXPECT_LT(squares, 1.3);
  EXPECT_LT(std::abs(bias), 0.01);
}

TEST(RestNoise, WhiteNoiseComesBackWithinItsSigma) { expect_honest({}); }

TEST(RestNoise, QuantisedNoiseComesBackWithQuantisation) {
  // Steps as an Aurora's file has them: 0.01 mm and 1e-4 of a quaternion.
  expect_honest({.step_m = 10e-6, .step_q = 1e-4}, 100e-12 / 12.0);
}

TEST(RestNoise, RepeatedRowsAreNoNewSamples) {
  const VirtualRest rest{.step_m = 10e-6, .step_q = 1e-4, .repeat_share = 0.5};
  expect_honest(rest, 100e-12 / 12.0);
  const RestNoise noise = rest_noise(rest, 4000, 7);
  // Runs of rows have a geometric length of mean 1 / (1 - p) = 2, weighted by length (1 + p) / (1 - p) = 3.
  EXPECT_NEAR(static_cast<double>(noise.distinct), 2000, 100);
  EXPECT_NEAR(noise.effective_samples, 4000.0 / 3.0, 300);
  EXPECT_NEAR(noise.correlation_time_s, 3 * 0.025, 0.02);
  EXPECT_NEAR(noise.white_m, std::sqrt((20e-6 * 20e-6 + 30e-6 * 30e-6 + 60e-6 * 60e-6 + 25e-12) / 3.0), 3e-6);
  EXPECT_LT(noise.slow_m, 0.3 * noise.white_m);
}

/// Without noise a step hides where in it the truth is: q^2 / 12. Against a numerical average over that place.
TEST(RestNoise, HiddenQuantisation) {
  constexpr double q = 2.0;
  for (const double sigma : {0.0, 0.2, 0.4, 0.7, 1.5}) {
    Draws draws(3);
    double hidden = 0.0, observed = 0.0;
    for (int place = 0; place < 200; ++place) {
      const double truth = q * (place + 0.5) / 200.0;
      double mean = 0.0, square = 0.0;
      for (int i = 0; i < 2000; ++i) {
        const double error = rounded(truth + sigma * draws.normal(), q) - truth;
        mean += error / 2000.0;
        square += error * error / 2000.0;
      }
      hidden += mean * mean / 200.0;
      observed += (square - mean * mean) / 200.0;
    }
    const double sampling = (sigma * sigma + q * q / 12.0) / 2000.0;  // of the mean's own scatter
    const double visible = sigma * sigma + q * q / 12.0;              // what the formula starts from
    EXPECT_NEAR(hidden_quantisation_variance(q, visible), hidden, 0.01 * q * q / 12.0 + 2.0 * sampling + 0.005)
        << sigma;
    EXPECT_NEAR(hidden + observed, visible, 0.02) << sigma;
  }
  EXPECT_EQ(hidden_quantisation_variance(0.0, 1.0), 0.0);
}

TEST(RestNoise, NeverSingular) {
  // Noise far below the step: nearly all rows are equal, and in some axes all.
  VirtualRest rest;
  rest.sigma_m = {20e-6, 1e-9, 1e-9};
  rest.sigma_rad = Vector3d::Constant(1e-8);
  rest.step_m = 50e-6;
  rest.step_q = 1e-4;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const RestNoise noise = rest_noise(rest, 500, seed);
    if (!noise.untold.empty()) continue;  // all rows alike
    EXPECT_TRUE(positive_definite(noise.covariance));
    EXPECT_GE(noise.covariance.diagonal().head<3>().minCoeff(), 50e-6 * 50e-6 / 13.0);
  }
}

TEST(RestNoise, OutliersAreLeftOut) {
  auto frames = VirtualRest().frames(1000, 5);
  for (std::size_t i = 10; i < 1000; i += 100) frames[i].readings[0].position_m.x() += 0.01;
  frames[500].readings[0].quaternion_wxyz = Eigen::Vector4d(0.5, 0.5, 0.5, 0.5);
  const RestNoise noise = identify_rest_noise(collect_samples(frames, 0));
  EXPECT_EQ(noise.outliers, 11u);
  EXPECT_NEAR(std::sqrt(noise.covariance(0, 0)), 20e-6, 2e-6);
}

TEST(RestNoise, DriftIsToldFromWhiteNoise) {
  VirtualRest rest;
  rest.sigma_m = Vector3d::Constant(30e-6);
  // Over T = 50 s a slope b has the variance (b T)^2 / 12: here (43 um)^2 along each axis.
  rest.drift_m_per_s = 3e-6;
  const RestNoise drifting = rest_noise(rest, 2000, 9);
  EXPECT_EQ(drifting.rest, Rest::kDrifts);
  EXPECT_NEAR(drifting.white_m, 30e-6, 2e-6);
  // A mean of so few independent readings is itself unsure; the scatter is enlarged by that.
  EXPECT_GT(drifting.slow_m, 0.95 * 150e-6 / std::sqrt(12.0));
  EXPECT_LT(drifting.slow_m, 1.3 * 150e-6 / std::sqrt(12.0));
  EXPECT_LT(drifting.effective_samples, 50);
  // White: the Allan deviation falls with the root of the window; drift turns it up again.
  EXPECT_GT(drifting.allan.position_m.back(),
            1.5 * *std::min_element(drifting.allan.position_m.begin(), drifting.allan.position_m.end()));
  const RestNoise still = rest_noise({}, 2000, 9);
  EXPECT_NEAR(still.allan.position_m[4] / still.allan.position_m[0],
              std::sqrt(still.allan.tau_s[0] / still.allan.tau_s[4]), 0.1);
  rest.drift_m_per_s = 30e-6;
  EXPECT_EQ(rest_noise(rest, 2000, 9).rest, Rest::kMoves);
}

TEST(RestNoise, CountsWhatIsNotUsable) {
  auto frames = VirtualRest().frames(400, 2);
  for (std::size_t i = 0; i < 40; ++i) frames[10 * i].readings[0].status = SensorReading::Status::kMissing;
  frames[5].readings[0].position_m.x() = std::numeric_limits<double>::quiet_NaN();
  frames[15].readings[0].status = SensorReading::Status::kAbsent;
  frames[25].time_s = frames[24].time_s;
  frames[35].time_s = std::numeric_limits<double>::quiet_NaN();
  const RestNoise noise = identify_rest_noise(collect_samples(frames, 0));
  EXPECT_EQ(noise.frames, 398u);
  EXPECT_EQ(noise.missing, 40u);
  EXPECT_EQ(noise.unusable, 1u);
  EXPECT_EQ(noise.bad_times, 1u);
  EXPECT_EQ(noise.used, 356u);
  EXPECT_NEAR(noise.timing.period_s, 0.025, 1e-9);
  EXPECT_NEAR(noise.timing.longest_gap_s, 0.05, 1e-9);
  const RestNoise part = identify_rest_noise(collect_samples(frames, 0, {1.0, 2.0}));
  EXPECT_EQ(part.frames, 41u);
}

TEST(RestNoise, TooLittleIsSaidNotGuessed) {
  auto frames = VirtualRest().frames(9, 2);
  EXPECT_EQ(identify_rest_noise(collect_samples(frames, 0)).untold,
            "9 usable readings, 9 of them distinct: expected at least 10 distinct ones");
  for (TrackerFrame& frame : frames) frame.readings[0].status = SensorReading::Status::kMissing;
  EXPECT_NE(identify_rest_noise(collect_samples(frames, 0)).untold, "");
  EXPECT_NE(identify_rest_noise(collect_samples({}, 0)).untold, "");
}

/// README of the data: 0.01-0.04 mm, 0.04-0.10 deg on the worst axis.
TEST(RestNoise, AuroraAtRest) {
  PALPATE_NEEDS_SHARED("data/ndi_aurora/NDIdata_snakeravenTest_2_2_21.csv");
  const auto recording = read_tracker_recording(test::shared_data("data/ndi_aurora/NDIdata_snakeravenTest_2_2_21.csv"));
  ASSERT_EQ(recording.sensor_names.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const RestNoise noise = identify_rest_noise(collect_samples(recording.frames, i));
    SCOPED_TRACE(recording.sensor_names[i]);
    ASSERT_EQ(noise.untold, "");
    EXPECT_TRUE(positive_definite(noise.covariance));
    EXPECT_NE(noise.rest, Rest::kMoves);
    EXPECT_GT(noise.worst_position_sigma_m(), 0.005e-3);
    EXPECT_LT(noise.worst_position_sigma_m(), 0.045e-3);
    EXPECT_GT(noise.worst_rotation_sigma_rad() / kRadiansPerDegree, 0.005);
    EXPECT_LT(noise.worst_rotation_sigma_rad() / kRadiansPerDegree, 0.11);
    EXPECT_NEAR(noise.timing.period_s, 0.047, 0.003);
  }
}

TEST(RestNoise, PlusReferenceRestsWhileStylusMoves) {
  PALPATE_NEEDS_SHARED("data/plus_tracker/ReferenceToRASCalibration.igs.mha");
  const auto recording =
      read_tracker_recording(test::shared_data("data/plus_tracker/ReferenceToRASCalibration.igs.mha"));
  for (std::size_t i = 0; i < recording.sensor_names.size(); ++i) {
    const RestNoise noise = identify_rest_noise(collect_samples(recording.frames, i));
    EXPECT_TRUE(noise.untold.empty() && positive_definite(noise.covariance));
    EXPECT_EQ(noise.rest == Rest::kMoves, recording.sensor_names[i] == "Stylus") << recording.sensor_names[i];
    if (recording.sensor_names[i] == "Stylus") continue;
    EXPECT_LT(noise.worst_position_sigma_m(), 0.1e-3);
  }
}

}  // namespace
}  // namespace palpate
