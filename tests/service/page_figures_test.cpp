// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <palpate/service/page_figures.hpp>
#include <random>

namespace palpate::service {
namespace {

Estimate estimate_of(const Vector3d& force_N, const Matrix3d& covariance_N2) {
  Estimate out;
  out.status = EstimateStatus::kUpdated;
  out.force_tip_N = force_N;
  out.covariance_tip_N2 = covariance_N2;
  return out;
}

Matrix3d some_covariance() {
  Matrix3d L = Matrix3d::Zero();
  L << 3e-3, 0.0, 0.0, 1e-3, 2e-3, 0.0, -2e-3, 1e-3, 4e-3;
  return L * L.transpose();
}

TEST(ForceParts, HeadOnFromTheSideAndPulled) {
  const Matrix3d P = 1e-6 * Matrix3d::Identity();
  const auto angle_deg = [&](const Vector3d& F) {
    return ForceParts(estimate_of(F, P)).angle_rad * 180.0 / std::numbers::pi;
  };
  EXPECT_NEAR(angle_deg({0.0, 0.0, -0.1}), 0.0, 1e-12);
  EXPECT_NEAR(angle_deg({0.06, 0.08, 0.0}), 90.0, 1e-12);
  EXPECT_NEAR(angle_deg({0.0, -0.1, -0.1}), 45.0, 1e-12);
  EXPECT_NEAR(angle_deg({0.0, 0.0, 0.1}), 180.0, 1e-12);
}

/// The sigmas against draws of the force.
TEST(ForceParts, SigmasAreThoseOfDraws) {
  const Vector3d F(0.05, -0.03, -0.12);
  const Matrix3d P = some_covariance();
  const ForceParts parts(estimate_of(F, P));
  const Matrix3d L = P.llt().matrixL();
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  constexpr int kDraws = 100000;
  Eigen::Array4d sum = Eigen::Array4d::Zero(), squares = Eigen::Array4d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Vector3d drawn = F + L * Vector3d(normal(engine), normal(engine), normal(engine));
    const double lateral = drawn.head<2>().norm();
    const Eigen::Array4d values(drawn.norm(), drawn.z(), lateral, std::atan2(lateral, -drawn.z()));
    sum += values;
    squares += values * values;
  }
  const Eigen::Array4d mean = sum / kDraws, sigma = (squares / kDraws - mean * mean).sqrt();
  EXPECT_NEAR(parts.sigma_size_N, sigma(0), 0.02 * sigma(0));
  EXPECT_NEAR(parts.sigma_axial_N, sigma(1), 0.02 * sigma(1));
  EXPECT_NEAR(parts.sigma_lateral_N, sigma(2), 0.02 * sigma(2));
  EXPECT_NEAR(parts.sigma_angle_rad, sigma(3), 0.02 * sigma(3));
}

TEST(ForceParts, NothingIsSaidOfWhatWasNotMeasured) {
  for (const EstimateStatus status : {EstimateStatus::kAmbiguous, EstimateStatus::kHeld, EstimateStatus::kStale}) {
    Estimate estimate = estimate_of({0.1, 0.0, 0.0}, some_covariance());
    estimate.status = status;
    const ForceParts parts(estimate);
    EXPECT_FALSE(parts.measured);
    EXPECT_TRUE(std::isnan(parts.size_N) && std::isnan(parts.sigma_lateral_N) && std::isnan(parts.angle_rad));
  }
  // A force within its own sigma has no direction.
  EXPECT_TRUE(std::isnan(ForceParts(estimate_of({1e-3, 0.0, 0.0}, some_covariance())).angle_rad));
}

session::LiveRecord record_at(double time_s, double force_N) {
  session::LiveRecord out;
  out.output_time_s = 1.7e9 + time_s;
  out.estimate = estimate_of({0.0, 0.0, -force_N}, 1e-8 * Matrix3d::Identity());
  return out;
}

TEST(LiveFigures, ContactIntegralAndBeat) {
  LiveFigures figures;
  const auto force = [](double t) { return 0.1 + 0.05 * std::sin(2.0 * std::numbers::pi * 1.2 * t); };
  for (int i = 0; i <= 480; ++i) figures.take(record_at(i / 40.0, i == 0 ? 0.0 : force(i / 40.0)));
  EXPECT_TRUE(figures.in_contact());
  EXPECT_NEAR(figures.contact().duration_s(), 12.0 - 1.0 / 40.0, 1e-6);
  EXPECT_NEAR(figures.contact().largest_N, 0.15, 1e-3);
  EXPECT_NEAR(figures.integral().integral_Ns, 1.2, 0.02);
  ASSERT_TRUE(figures.beat());
  EXPECT_NEAR(figures.beat()->per_min, 72.0, 1.0);
  // Silence: the contact is over, what it was stays.
  session::LiveRecord stale = record_at(12.5, 0.1);
  stale.kind = session::LiveRecord::Kind::kStale;
  figures.take(stale);
  EXPECT_FALSE(figures.in_contact());
  EXPECT_FALSE(figures.latest().measured);
  EXPECT_NEAR(figures.contact().integral_Ns, 1.2, 0.02);
  EXPECT_NEAR(figures.integral().unmeasured_s, 0.5, 1e-6);
}

TEST(LiveFigures, ASingleFrameIsNoContact) {
  LiveFigures figures;
  for (int i = 0; i < 10; ++i) {
    figures.take(record_at(0.025 * i, i == 5 ? 0.2 : 0.0));
    EXPECT_FALSE(figures.in_contact()) << i;
  }
}

PageHistory::Row past_row(double time_s, double size_N) {
  PageHistory::Row row{};
  row[0] = time_s;
  row[3] = size_N;
  return row;
}

std::vector<std::pair<double, double>> rows_of(const PageHistory& past) {
  std::vector<double> numbers;
  past.append_to(numbers);
  std::vector<std::pair<double, double>> out;
  for (std::size_t i = 0; i < numbers.size(); i += kPageHistory.size()) out.emplace_back(numbers[i], numbers[i + 3]);
  return out;
}

TEST(PageHistory, NoPeakIsLostAndTimeRises) {
  PageHistory past;
  for (int i = 0; i < 1000; ++i) past.take(past_row(100.0 + 1e-3 * i, i == 555 ? 9.0 : 1.0));
  const auto rows = rows_of(past);
  ASSERT_EQ(rows.size(), 10U);
  EXPECT_EQ(rows[5], std::make_pair(100.0 + 1e-3 * 555, 9.0));
  past.take(past_row(100.5, 99.0));  // time that steps back says nothing
  EXPECT_EQ(rows_of(past), rows);
}

TEST(PageHistory, WhatWasNotMeasuredGivesWayToWhatWas) {
  PageHistory past;
  past.take(past_row(0.01, std::nan("")));
  EXPECT_TRUE(std::isnan(rows_of(past)[0].second));
  past.take(past_row(0.02, 0.3));
  past.take(past_row(0.03, std::nan("")));
  EXPECT_EQ(rows_of(past), (std::vector<std::pair<double, double>>{{0.02, 0.3}}));
}

TEST(PageHistory, KeepsTenMinutes) {
  PageHistory past;
  for (int i = 0; i < 7000; ++i) past.take(past_row(0.1 * i + 0.05, i));
  const auto rows = rows_of(past);
  ASSERT_EQ(rows.size(), 6000U);
  EXPECT_EQ(rows.front().second, 1000.0);
  EXPECT_EQ(rows.back().second, 6999.0);
}

}  // namespace
}  // namespace palpate::service
