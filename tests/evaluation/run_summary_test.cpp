// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/evaluation/run_summary.hpp>

namespace palpate {
namespace {

Estimate updated(double time_s, const Vector3d& force, double sigma_N, double nis, int evaluations) {
  Estimate e;
  e.time_s = time_s;
  e.time = FrameTime::kAdvanced;
  e.status = EstimateStatus::kUpdated;
  e.force_tip_N = force;
  e.force_base_N = -force;
  e.covariance_tip_N2 = sigma_N * sigma_N * Matrix3d::Identity();
  e.used = 0b11;
  e.sensors_used = 2;
  e.nis = nis;
  e.dof = 12;
  e.evaluations = evaluations;
  e.convergence = {.paper = nis / 100.0, .normalised = nis / 10.0};
  return e;
}

TEST(RunSummary, EveryFrameAndEveryReadingIsAccountedFor) {
  RunSummaryBuilder builder;
  Estimate first = updated(1.0, {1, 0, 0}, 0.1, 6.0, 2);
  first.time = FrameTime::kFirst;
  builder.add(first, 2);
  Estimate second = updated(2.0, {0, 3, 0}, 0.3, 18.0, 40);
  second.rejections[1] = Rejection::kOutlier;
  builder.add(second, 2);
  builder.add(updated(3.0, {0, 0, -2}, 0.2, 12.0, 3), 2);
  Estimate held;
  held.time_s = 4.0;
  held.time = FrameTime::kAdvanced;
  held.rejections = {Rejection::kMissing, Rejection::kNotFinite, Rejection::kOutlier};  // the third is not in use
  held.force_tip_N = {0, 0, -2};
  held.force_base_N = {0, 0, 5};
  held.covariance_tip_N2 = Matrix3d::Identity();
  builder.add(held, 2);
  for (const FrameTime time :
       {FrameTime::kStandsStill, FrameTime::kStepsBack, FrameTime::kStepsBack, FrameTime::kNotFinite}) {
    Estimate rejected = held;
    rejected.time_s = 4.0;
    rejected.time = time;
    rejected.status = EstimateStatus::kRejected;
    builder.add(rejected, 2);
  }
  const RunSummary s = builder.finish();
  EXPECT_EQ(s.frames, 8U);
  EXPECT_EQ(s.first_time_s, 1.0);
  EXPECT_EQ(s.last_time_s, 4.0);
  EXPECT_EQ(s.by_status, (std::array<std::size_t, kEstimateStatuses>{3, 0, 0, 4, 1, 0, 0}));
  EXPECT_EQ(s.readings_by_reason, (std::array<std::size_t, kRejections>{5, 1, 1, 0, 0, 0, 0, 1}));
  EXPECT_EQ(s.time_stood_still, 1U);
  EXPECT_EQ(s.time_stepped_back, 2U);
  EXPECT_EQ(s.time_not_finite, 1U);
  EXPECT_EQ(s.clock_resynchronised, 0U);
  EXPECT_LT((s.mean_force_tip_N - Vector3d(1.0 / 3, 1.0, -2.0 / 3)).norm(), 1e-12);
  EXPECT_LT((s.median_sigma_N - Vector3d::Constant(0.2)).norm(), 1e-6);
  EXPECT_EQ(s.last_force_tip_N, Vector3d(0, 0, -2));
  EXPECT_EQ(s.last_force_base_N, Vector3d(0, 0, 5));
  EXPECT_EQ(s.last_sigma_N, Vector3d::Ones());
  EXPECT_EQ(s.largest_force_N, 3.0);
  EXPECT_NEAR(s.mean_nis_per_dof, 1.0, 1e-12);
  EXPECT_NEAR(s.mean_rho_paper, 0.12, 1e-12);
  EXPECT_NEAR(s.mean_rho_normalised, 1.2, 1e-12);
  EXPECT_EQ(s.median_evaluations, 3.0);
  EXPECT_EQ(s.most_evaluations, 40);
}

TEST(RunSummary, SensorsThatAreNotInAFrameAreCountedApart) {
  RunSummaryBuilder builder;
  Estimate e = updated(1.0, {0, 0, 0}, 0.1, 12.0, 1);
  e.rejections = {Rejection::kNone, Rejection::kAbsent, Rejection::kMissing};
  builder.add(e, 3);
  const RunSummary s = builder.finish();
  EXPECT_EQ(s.readings_by_reason, (std::array<std::size_t, kRejections>{1, 1, 0, 0, 0, 0, 0, 0, 1}));
}

TEST(RunSummary, EmptyRunIsAllZeros) {
  const RunSummary s = RunSummaryBuilder{}.finish();
  EXPECT_EQ(s.frames, 0U);
  EXPECT_EQ(s.mean_force_tip_N, Vector3d::Zero());
  EXPECT_EQ(s.median_evaluations, 0.0);
}

TEST(RunSummary, ReadingsOfAResynchronisedFrameCount) {
  RunSummaryBuilder builder;
  Estimate e = updated(1.0, {0, 0, 0}, 0.1, 12.0, 1);
  e.time = FrameTime::kResynchronised;
  builder.add(e, 3);
  const RunSummary s = builder.finish();
  EXPECT_EQ(s.clock_resynchronised, 1U);
  EXPECT_EQ(s.readings_by_reason[0], 3U);
}

}  // namespace
}  // namespace palpate
