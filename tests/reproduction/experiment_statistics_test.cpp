// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/reproduction/experiment_statistics.hpp>
#include <vector>

namespace palpate::reproduction {
namespace {

/// By hand. Errors along x: (9), 1, 2, 3 -> mean 2, deviation sqrt((1 + 0 + 1) / 2) = 1; the first frame is left out.
TEST(ExperimentStatistics, OfOneRepeatAreMeanAndDeviationOverTime) {
  const std::vector<Vector3d> truth(4, Vector3d(0.5, 0.0, -1.0));
  const std::vector<Vector3d> errors = {{9.0, 9.0, 9.0}, {1.0, -4.0, 0.0}, {2.0, -4.0, 3.0}, {3.0, -4.0, -3.0}};
  std::vector<Vector3d> estimate;
  for (std::size_t i = 0; i < errors.size(); ++i) estimate.emplace_back(truth[i] + errors[i]);
  const ErrorStatistics s = error_statistics(estimate, truth, 1);
  EXPECT_LT((s.mean_N - Vector3d(2.0, -4.0, 0.0)).norm(), 1e-14);
  EXPECT_NEAR(s.sigma_N.x(), 1.0, 1e-14);
  EXPECT_NEAR(s.sigma_N.y(), 0.0, 1e-14);
  EXPECT_NEAR(s.sigma_N.z(), 3.0, 1e-14);
}

/// Means 1, -3 -> |.| 1, 3: average 2, spread sqrt(1 + 1) = 1.414; an average without the bars would be -1.
TEST(ExperimentStatistics, OverRepeatsSignsDoNotCancel) {
  const std::vector<ErrorStatistics> repeats = {{Vector3d::Constant(1.0), Vector3d::Constant(2.0)},
                                                {Vector3d::Constant(-3.0), Vector3d::Constant(6.0)}};
  const RepeatStatistics s = over_repeats(repeats);
  EXPECT_NEAR(s.mean_N.z(), 2.0, 1e-14);
  EXPECT_NEAR(s.mean_spread_N.z(), std::sqrt(2.0), 1e-14);
  EXPECT_NEAR(s.sigma_N.y(), 4.0, 1e-14);
  EXPECT_NEAR(s.sigma_spread_N.y(), std::sqrt(8.0), 1e-14);
}

/// Errors 0, 1.9, -1.95, 2 with sigma 1, 1, 1, 1: three of four inside 1.96. Along y sigma is 0.5: one of four.
TEST(ExperimentStatistics, CountsTheFramesInsideTheInterval) {
  const std::vector<Vector3d> truth(4, Vector3d::Zero()), sigma(4, Vector3d(1.0, 0.5, 10.0));
  const std::vector<Vector3d> estimate = {Vector3d::Zero(), Vector3d::Constant(1.9), Vector3d::Constant(-1.95),
                                          Vector3d::Constant(2.0)};
  EXPECT_EQ(inside_95(estimate, truth, sigma, 0), Vector3d(0.75, 0.25, 1.0));
}

}  // namespace
}  // namespace palpate::reproduction
