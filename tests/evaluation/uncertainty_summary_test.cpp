// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <palpate/evaluation/run_summary.hpp>

namespace palpate {
namespace {

constexpr auto kNoise = static_cast<std::size_t>(UncertaintySource::kNoise);
constexpr auto kTendon = static_cast<std::size_t>(UncertaintySource::kTendon);

Estimate used(double noise_N, double tendon_N, double weakest_sigmas) {
  Estimate e;
  e.used = 1;
  e.dof = 6;
  e.status = EstimateStatus::kUpdated;
  e.sigma_by_source_N[kNoise] = noise_N * Vector3d(1, 2, 3);
  e.sigma_by_source_N[kTendon] = {tendon_N, 0.0, 0.0};
  e.observability.weakest_force_N = {0.0, 0.0, weakest_sigmas};
  e.observability.weakest_log_stiffness = Vector3d::Constant(2.0 * weakest_sigmas);
  e.observability.weakest_precurvature_per_m = {3.0 * weakest_sigmas, 0.0, 0.0};
  e.observability.weakest_sigmas = weakest_sigmas;
  return e;
}

TEST(UncertaintySummary, MediansAreOverUsedFrames) {
  UncertaintySummaryBuilder builder;
  builder.add(used(0.5, 0.0, 0.75));
  builder.add(used(0.25, 0.0, 0.5));
  builder.add(used(4.0, 8.0, 0.25));
  Estimate held = used(100.0, 100.0, 100.0);
  held.used = 0;
  builder.add(held);
  builder.add(held);
  builder.add(held);
  const UncertaintySummary s = builder.finish();
  EXPECT_EQ(s.frames_used, 3U);
  EXPECT_EQ(s.median_sigma_by_source_N[kNoise], Vector3d(0.5, 1.0, 1.5));
  EXPECT_EQ(s.median_sigma_by_source_N[kTendon], Vector3d::Zero()) << "zero in two frames of three";
  EXPECT_EQ(s.median_sigma_by_source_N[1], Vector3d::Zero());
  EXPECT_EQ(s.weakest.prior_sigmas, 0.5);
  EXPECT_EQ(s.weakest.force_N, Vector3d(0, 0, 0.5));
  EXPECT_EQ(s.weakest.log_stiffness, Vector3d::Ones());
  EXPECT_EQ(s.weakest.precurvature_per_m, Vector3d(1.5, 0, 0));
}

TEST(UncertaintySummary, MedianWhereSomeFramesAreFreeOfASource) {
  UncertaintySummaryBuilder builder;
  for (const double tendon_N : {4.0, 0.0, 1.0, 0.0, 2.0}) builder.add(used(1.0, tendon_N, 1.0));
  EXPECT_EQ(builder.finish().median_sigma_by_source_N[kTendon].x(), 1.0);
}

TEST(UncertaintySummary, BlindFramesAreTheWeakest) {
  UncertaintySummaryBuilder builder;
  const double inf = std::numeric_limits<double>::infinity();
  for (const double sigmas : {inf, 0.5, std::nan(""), inf}) builder.add(used(1.0, 0.0, sigmas));
  EXPECT_EQ(builder.finish().weakest.prior_sigmas, inf);
}

TEST(UncertaintySummary, HiddenFramesAreCountedByCause) {
  UncertaintySummaryBuilder builder;
  const auto add = [&](const Observability& observability, unsigned sensors) {
    Estimate e = used(1.0, 0.0, 1.0);
    e.used = sensors;
    e.observability = observability;
    builder.add(e);
  };
  add({}, 1);
  add({.shaft_straight = true}, 1);
  add({.axial_force_hidden = true}, 1);
  add({.axial_force_hidden = true, .shaft_straight = true, .stiffness_rests_on_prior = true}, 1);
  add({.lateral_force_hidden = true, .precurvature_rests_on_prior = true}, 1);
  add({.axial_force_hidden = true, .stiffness_rests_on_prior = true, .stiffness_scale_sigma = 0.05}, 0);
  const UncertaintySummary s = builder.finish();
  EXPECT_EQ(s.frames_used, 5U);
  EXPECT_EQ(s.hidden.axial_force, 2U);
  EXPECT_EQ(s.hidden.axial_force_straight, 1U);
  EXPECT_EQ(s.hidden.lateral_force, 1U);
  EXPECT_EQ(s.hidden.stiffness_scale, 1U);
  EXPECT_EQ(s.hidden.precurvature, 1U);
  EXPECT_EQ(s.last_observability.stiffness_scale_sigma, 0.05) << "the last frame's, used or not";
}

TEST(UncertaintySummary, IsPartOfTheRuns) {
  RunSummaryBuilder builder;
  Estimate e = used(0.5, 0.0, 0.75);
  e.covariance_tip_N2 = 4.0 * Matrix3d::Identity();
  e.shaft.stiffness_Nm2 = {1, 2, 3};
  builder.add(e, 1);
  const UncertaintySummary s = builder.finish().uncertainty;
  EXPECT_EQ(s.frames_used, 1U);
  EXPECT_EQ(s.median_sigma_by_source_N[kNoise].x(), 0.5);
  EXPECT_EQ(s.last_covariance_tip_N2, e.covariance_tip_N2);
  EXPECT_EQ(s.last_shaft.stiffness_Nm2, Vector3d(1, 2, 3));
}

TEST(UncertaintySummary, EmptyRunIsAllZeros) {
  const UncertaintySummary s = UncertaintySummaryBuilder{}.finish();
  EXPECT_EQ(s.frames_used, 0U);
  EXPECT_EQ(s.weakest.prior_sigmas, 0.0);
  EXPECT_EQ(s.median_sigma_by_source_N[kNoise], Vector3d::Zero());
}

}  // namespace
}  // namespace palpate
