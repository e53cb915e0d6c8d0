// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <numeric>
#include <palpate/evaluation/contacts.hpp>
#include <palpate/math/errors.hpp>
#include <random>

namespace palpate {
namespace {

std::vector<ForceSize> sampled(double to_s, double step_s, double (*force_N)(double)) {
  std::vector<ForceSize> frames;
  for (int i = 0; i * step_s <= to_s + 1e-9; ++i) frames.push_back({i * step_s, force_N(i * step_s), 1e-3, true});
  return frames;
}

/// A half sine of 0.2 N over each odd second; nothing between.
double half_sines(double t) {
  return static_cast<int>(t) % 2 == 1 ? 0.2 * std::sin(std::numbers::pi * (t - std::floor(t))) : 0.0;
}

TEST(Contacts, IntegralOfHalfSines) {
  const auto contacts = find_contacts(sampled(4.0, 1e-3, half_sines), {.on_N = 0.02, .off_share = 0.5});
  ASSERT_EQ(contacts.size(), 2u);
  // From sin^-1(0.1) up to sin^-1(0.05) down: 0.2 / pi (cos a + cos b), and the time between them.
  const double a = std::asin(0.1), b = std::asin(0.05), pi = std::numbers::pi;
  for (const Contact& contact : contacts) {
    EXPECT_NEAR(contact.integral_Ns, 0.2 / pi * (std::cos(a) + std::cos(b)), 4e-5);
    EXPECT_NEAR(contact.duration_s(), (pi - a - b) / pi, 2e-3);
    EXPECT_NEAR(contact.largest_N, 0.2, 1e-6);
    EXPECT_NEAR(contact.mean_N() * contact.duration_s(), contact.integral_Ns, 1e-12);
    EXPECT_NEAR(contact.integral_sigma_Ns, 1e-3 * contact.duration_s(), 1e-12);
    EXPECT_EQ(contact.bridged_s, 0.0);
  }
  EXPECT_NEAR(contacts[1].largest_at_s, 3.5, 1e-6);
}

TEST(Contacts, HysteresisHoldsAChatteringForceTogether) {
  auto frames = sampled(1.0, 0.01, [](double) { return 0.05; });
  for (std::size_t i = 0; i < frames.size(); i += 2) frames[i].size_N = 0.04;
  EXPECT_EQ(find_contacts(frames, {.on_N = 0.05, .off_share = 0.7}).size(), 1u);
  EXPECT_EQ(find_contacts(frames, {.on_N = 0.05, .off_share = 1.0}).size(), 0u);  // single frames
}

TEST(Contacts, AForceThatItsSigmaHidesIsNone) {
  auto frames = sampled(1.0, 0.01, [](double) { return 0.1; });
  for (ForceSize& frame : frames) frame.sigma_N = 0.06;
  EXPECT_TRUE(find_contacts(frames).empty());
  for (ForceSize& frame : frames) frame.sigma_N = 0.05;
  EXPECT_EQ(find_contacts(frames).size(), 1u);
}

TEST(Contacts, WhatWasNotMeasuredIsBridgedOrEndsIt) {
  auto frames = sampled(2.0, 0.01, [](double) { return 0.1; });
  for (std::size_t i = 50; i < 60; ++i) frames[i] = {frames[i].time_s, 9.0, 9.0, false};
  auto contacts = find_contacts(frames);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_NEAR(contacts[0].bridged_s, 0.11, 1e-12);
  EXPECT_NEAR(contacts[0].integral_Ns, 0.2, 1e-12);
  EXPECT_EQ(contacts[0].largest_N, 0.1);
  for (std::size_t i = 50; i < 80; ++i) frames[i].measured = false;
  contacts = find_contacts(frames);
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_NEAR(contacts[0].to_s, 0.49, 1e-12);
  EXPECT_NEAR(contacts[1].from_s, 0.80, 1e-12);
}

TEST(Contacts, AClockThatStepsBackEndsOne) {
  auto frames = sampled(1.0, 0.01, [](double) { return 0.1; });
  for (std::size_t i = 50; i < frames.size(); ++i) frames[i].time_s -= 0.4;
  const auto contacts = find_contacts(frames);
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_GT(contacts[0].integral_Ns, 0.0);
  EXPECT_GT(contacts[1].integral_Ns, 0.0);
}

TEST(Contacts, RuleOutOfRange) {
  EXPECT_THROW(find_contacts({}, {.on_N = 0.0}), InputError);
  EXPECT_THROW(find_contacts({}, {.off_share = 1.5}), InputError);
  EXPECT_NE(in_words({}).find("5 g (49.03 mN)"), std::string::npos) << in_words({});
}

TEST(TimeInBands, EverySecondIsSomewhere) {
  auto frames = sampled(4.0, 0.01, half_sines);
  for (std::size_t i = 100; i < 110; ++i) frames[i].measured = false;
  frames.push_back({5.0, 0.0, 1e-3, true});
  const std::vector<double> edges_N{0.1, 0.2};
  const TimeInBands bands = time_in_bands(frames, edges_N);
  ASSERT_EQ(bands.seconds.size(), 3u);
  EXPECT_NEAR(bands.total_s, 5.0, 1e-9);
  EXPECT_NEAR(std::accumulate(bands.seconds.begin(), bands.seconds.end(), bands.not_measured_s), 5.0, 1e-9);
  EXPECT_NEAR(bands.seconds[1] + bands.seconds[2], 2.0 * 2.0 / 3.0, 0.03);  // sin > 1/2 over two thirds of a half sine
  EXPECT_NEAR(bands.not_measured_s, 0.1 + 0.75, 1e-9);                      // a frame stands for 0.25 s at most
}

TEST(TimeInBands, EdgesMustRise) {
  const std::vector<double> flat{0.1, 0.1}, negative{-0.1};
  EXPECT_THROW(time_in_bands({}, flat), InputError);
  EXPECT_THROW(time_in_bands({}, negative), InputError);
}

TEST(SigmaOfNorm, AgreesWithDraws) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  Matrix3d P;
  P << 4.0, 1.0, 0.5, 1.0, 9.0, -2.0, 0.5, -2.0, 25.0;
  P *= 1e-6;
  const Matrix3d root = P.llt().matrixL();
  for (const Vector3d& mean : {Vector3d(0.05, 0.0, 0.0), Vector3d(0.01, 0.02, -0.03), Vector3d(0.0, 0.0, 0.1)}) {
    double sum = 0.0, squares = 0.0;
    constexpr int kDraws = 40000;
    for (int i = 0; i < kDraws; ++i) {
      const double size = (mean + root * Vector3d(normal(random), normal(random), normal(random))).norm();
      sum += size;
      squares += size * size;
    }
    const double sigma = std::sqrt(squares / kDraws - std::pow(sum / kDraws, 2));
    EXPECT_NEAR(sigma_of_norm(mean, P), sigma, 0.03 * sigma);
  }
  EXPECT_NEAR(sigma_of_norm(Vector3d(Vector3d::Zero()), Matrix3d(4e-6 * Matrix3d::Identity())), 2e-3, 1e-15);
}

}  // namespace
}  // namespace palpate
