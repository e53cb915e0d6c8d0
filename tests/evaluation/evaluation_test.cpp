// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/evaluation/evaluation.hpp>
#include <palpate/math/errors.hpp>

namespace palpate {
namespace {

EstimateRow row(double time_s, const Vector3d& force, EstimateStatus status = EstimateStatus::kUpdated) {
  EstimateRow out{.time_s = time_s, .force_tip_N = force, .status = status};
  out.covariance_tip_N2.diagonal() << 0.01, 0.04, 1.0;  // sigma 0.1, 0.2, 1
  return out;
}

/// z rises by 1 N/s.
ForceTrace ramp() {
  return {.source = "truth.csv", .times_s = {0.0, 10.0}, .force_tip_N = {{0, 0, 0}, {0, 0, 10}}, .force_base_N = {}};
}

/// Five rows; the one at 4.5 s lies in the skipped second (estimate starts at 4). Errors of the other four:
///   x  0.1  -0.1   0.3   0.1    mean 0.1,  mean square 0.03  -> rmse sqrt 0.03,  sigma sqrt 0.02
///   y  0     0     0     0.4    mean 0.1,  mean square 0.04  -> rmse 0.2,        sigma sqrt 0.03
///   z -2     2    -1     1      mean 0,    mean square 2.5   -> rmse sqrt 2.5 = sigma
/// NEES: 1 + 0 + 4 = 5;  1 + 0 + 4 = 5;  9 + 0 + 1 = 10;  1 + 4 + 1 = 6: mean 6.5.
TEST(Evaluation, FiveRowsByHand) {
  const std::vector<EstimateRow> rows{
      row(4.0, {9, 9, 9}),
      row(5.0, {0.1, 0.0, 3.0}),
      row(6.0, {-0.1, 0.0, 8.0}, EstimateStatus::kHeld),
      row(7.0, {0.3 - 1e-12, 0.0, 6.0}, EstimateStatus::kReseeded),
      row(8.0, {0.1, 0.4, 9.0}, EstimateStatus::kRejected),
  };
  const Evaluation e = evaluate(rows, ramp());
  EXPECT_EQ(e.frames, 4U);
  EXPECT_EQ(e.updated, 2U);
  EXPECT_EQ(e.outside_truth, 0U);
  EXPECT_LT((e.mean_N - Vector3d(0.1, 0.1, 0.0)).norm(), 1e-9);
  EXPECT_LT((e.rmse_N - Vector3d(std::sqrt(0.03), 0.2, std::sqrt(2.5))).norm(), 1e-9);
  EXPECT_LT((e.sigma_N - Vector3d(std::sqrt(0.02), std::sqrt(0.03), std::sqrt(2.5))).norm(), 1e-9);
  EXPECT_LT((e.largest_N - Vector3d(0.3, 0.4, 2.0)).norm(), 1e-9);
  EXPECT_LT((e.inside_95 - Vector3d(0.75, 0.75, 0.5)).norm(), 1e-12);
  EXPECT_LT((e.inside_3_sigma - Vector3d(1.0, 1.0, 1.0)).norm(), 1e-12);
  EXPECT_NEAR(e.mean_nees, 6.5, 1e-9);
}

TEST(Evaluation, TruthIsInterpolatedInTime) {
  const std::vector<EstimateRow> rows{row(0.0, Vector3d::Zero()), row(1.2345, {0.0, 0.0, 1.2345})};
  EXPECT_LT(evaluate(rows, ramp()).rmse_N.norm(), 1e-12);
}

TEST(Evaluation, FramesOutsideTheTruthAreCountedNotJudged) {
  const std::vector<EstimateRow> rows{row(-5.0, Vector3d::Zero()), row(-2.0, {9, 9, 9}), row(5.0, {0, 0, 5}),
                                      row(10.0, {0, 0, 10}), row(10.5, {9, 9, 9})};
  const Evaluation e = evaluate(rows, ramp());
  EXPECT_EQ(e.frames, 2U);
  EXPECT_EQ(e.outside_truth, 2U);
  EXPECT_LT(e.rmse_N.norm(), 1e-12);
}

TEST(Evaluation, FrameThatEndsTheSkippedTimeCounts) {
  const std::vector<EstimateRow> rows{row(0.0, {9, 9, 9}), row(1.0, {0, 0, 1}), row(2.0, {0, 0, 2})};
  EXPECT_EQ(evaluate(rows, ramp()).frames, 2U);
  EXPECT_EQ(evaluate(rows, ramp(), 0.0).frames, 3U);
  EXPECT_EQ(evaluate(rows, ramp(), 1.5).frames, 1U);
}

TEST(Evaluation, CorrelatedCovarianceCounts) {
  EstimateRow r = row(5.0, {1.0, 1.0, 5.0});
  r.covariance_tip_N2 << 2.0, 1.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 1.0;  // inverse of (2 1; 1 2): (2 -1; -1 2) / 3
  EXPECT_NEAR(evaluate(std::vector{r}, ramp(), 0.0).mean_nees, 2.0 / 3.0, 1e-12);
}

TEST(Evaluation, NothingLeftToJudgeIsRefused) {
  const std::vector<EstimateRow> early{row(0.0, Vector3d::Zero()), row(0.5, Vector3d::Zero())};
  const std::vector<EstimateRow> late{row(100.0, Vector3d::Zero()), row(105.0, Vector3d::Zero())};
  EXPECT_THROW(evaluate(early, ramp()), InputError);
  EXPECT_THROW(evaluate(late, ramp()), InputError);
  EXPECT_THROW(evaluate({}, ramp()), InputError);
}

/// A time that is not a number belongs to a rejected frame; it is not judged, wherever it stands.
TEST(Evaluation, RowsWithoutATimeAreNotJudged) {
  const double kNaN = std::nan("");
  const std::vector<EstimateRow> rows{row(kNaN, {9, 9, 9}), row(0.0, {9, 9, 9}), row(5.0, {0, 0, 5}),
                                      row(kNaN, {9, 9, 9})};
  const Evaluation e = evaluate(rows, ramp());
  EXPECT_EQ(e.frames, 1U);
  EXPECT_LT(e.rmse_N.norm(), 1e-12);
}

}  // namespace
}  // namespace palpate
