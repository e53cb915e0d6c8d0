// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numeric>
#include <palpate/estimation/adaptation.hpp>
#include <tests/estimation/linear_models.hpp>

namespace palpate {
namespace {

using test::Draws;

Channels channels_from(int first) {
  Channels channels{};
  std::iota(channels.begin(), channels.end(), first);
  return channels;
}

/// A random walk in 3-D seen through six rows of stated variance 1, true standard deviation `noise_factor`; the filter
/// uses the adapted noise. Returns the ratio of each channel's variance to the stated one, averaged over the second
/// half.
Eigen::VectorXd settled_ratio(double noise_factor, int window, unsigned seed) {
  constexpr int kSteps = 4000;
  Draws draws(seed);
  const Eigen::MatrixXd H = test::random_matrix(6, 3, draws);
  const Channels channels = channels_from(0);
  const ResidualMatrix nominal = ResidualMatrix::Identity(6, 6);
  NoiseAdaptation adaptation(6, window);
  Gaussian state{StateVector::Zero(3), StateMatrix::Identity(3, 3)};
  Eigen::Vector3d truth = Eigen::Vector3d::Zero();
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(6);
  for (int step = 0; step < kSteps; ++step) {
    truth += 0.3 * draws.normal3();
    state.covariance.diagonal().array() += 0.09;
    ResidualMatrix adapted = nominal;
    adaptation.apply(channels, adapted);
    test::LinearModel model{H, adapted, H * truth + noise_factor * test::random_matrix(6, 1, draws)};
    Update update;
    iterated_update(model, state, state.mean, {}, update);
    state = update.posterior;
    adaptation.observe(channels, nominal, update.at, state.covariance);
    if (step >= kSteps / 2)
      for (int i = 0; i < 6; ++i) mean(i) += adaptation.ratio(i) / (kSteps / 2);
  }
  return mean;
}

/// Covariance matching is a fixed point, not an unbiased estimator: a channel that the estimate follows closely keeps
/// the variance it believes in. And the ratio is shrunk towards 1 by 10 samples, of 110: from 9 to 8.3, from 1/9 to
/// 0.19. So: within a factor 1.5 of the shrunk value on the mean over the channels.
TEST(NoiseAdaptation, FindsNoiseThreeTimesAsLargeAsStated) {
  const double shrunk = (10.0 + 100.0 * 9.0) / 110.0;
  const double found = settled_ratio(3.0, 100, 61).mean();
  EXPECT_GT(found, shrunk / 1.5);
  EXPECT_LT(found, shrunk * 1.5);
}

TEST(NoiseAdaptation, FindsNoiseAThirdOfTheStated) {
  const double shrunk = (10.0 + 100.0 / 9.0) / 110.0;
  const double found = settled_ratio(1.0 / 3.0, 100, 62).mean();
  EXPECT_GT(found, shrunk / 1.5);
  EXPECT_LT(found, shrunk * 1.5);
}

TEST(NoiseAdaptation, RightNoiseStaysRight) { EXPECT_NEAR(settled_ratio(1.0, 100, 63).mean(), 1.0, 0.15); }

Linearization constant(double residual) {
  Linearization at;
  at.residual = ResidualVector::Constant(1, residual);
  at.jacobian = JacobianMatrix::Zero(1, 1);
  return at;
}

/// By hand: residuals 1, 3 have variance 2 (n - 1), J P J^T = 0.5 each, R0 = 4: matched (2 + 0.5) / 4 = 0.625, shrunk
/// (10 + 2 x 0.625) / 12 = 0.9375.
TEST(NoiseAdaptation, TwoSamplesByHand) {
  NoiseAdaptation adaptation(1, 5);
  const ResidualMatrix nominal = ResidualMatrix::Constant(1, 1, 4.0);
  const StateMatrix P = StateMatrix::Constant(1, 1, 0.5);
  for (const double r : {1.0, 3.0}) {
    Linearization at = constant(r);
    at.jacobian(0, 0) = 1.0;
    EXPECT_EQ(adaptation.ratio(0), 1.0);
    adaptation.observe(channels_from(0), nominal, at, P);
  }
  EXPECT_NEAR(adaptation.ratio(0), 0.9375, 1e-14);
}

TEST(NoiseAdaptation, ForgetsWhatIsOlderThanTheWindow) {
  NoiseAdaptation adaptation(1, 5), fresh(1, 5);
  const ResidualMatrix nominal = ResidualMatrix::Identity(1, 1);
  const StateMatrix P = StateMatrix::Identity(1, 1);
  for (int i = 0; i < 7; ++i) adaptation.observe(channels_from(0), nominal, constant(100.0 * i), P);
  for (int i = 0; i < 5; ++i) {
    adaptation.observe(channels_from(0), nominal, constant(i), P);
    fresh.observe(channels_from(0), nominal, constant(i), P);
  }
  EXPECT_NEAR(adaptation.ratio(0), fresh.ratio(0), 1e-12);
}

TEST(NoiseAdaptation, StaysWithinItsLimits) {
  const ResidualMatrix nominal = ResidualMatrix::Identity(1, 1);
  const StateMatrix P = StateMatrix::Identity(1, 1);
  NoiseAdaptation quiet(1, 1000), loud(1, 1000);
  for (int i = 0; i < 1000; ++i) {
    quiet.observe(channels_from(0), nominal, constant(0.0), P);
    loud.observe(channels_from(0), nominal, constant(i % 2 ? 1e6 : -1e6), P);
  }
  EXPECT_EQ(quiet.ratio(0), NoiseAdaptation::kLeastRatio);
  EXPECT_EQ(loud.ratio(0), NoiseAdaptation::kLargestRatio);
}

TEST(NoiseAdaptation, ChannelsThatAFrameLacksStayAsTheyAre) {
  NoiseAdaptation adaptation(6, 15);
  const ResidualMatrix nominal = ResidualMatrix::Identity(1, 1);
  const StateMatrix P = StateMatrix::Identity(1, 1);
  for (int i = 0; i < 30; ++i) adaptation.observe(channels_from(4), nominal, constant(i % 2 ? 9.0 : -9.0), P);
  for (const int channel : {0, 1, 2, 3, 5}) EXPECT_EQ(adaptation.ratio(channel), 1.0);
  EXPECT_GT(adaptation.ratio(4), 10.0);
}

TEST(NoiseAdaptation, AppliesItselfToRowsAndColumnsOfTheRowsChannel) {
  NoiseAdaptation adaptation(8, 15);
  const ResidualMatrix one = ResidualMatrix::Identity(1, 1);
  for (int i = 0; i < 30; ++i)
    adaptation.observe(channels_from(7), one, constant(i % 2 ? 9.0 : -9.0), StateMatrix::Identity(1, 1));
  const double ratio = adaptation.ratio(7);
  ResidualMatrix noise(2, 2);
  noise << 4.0, 1.0, 1.0, 2.0;
  adaptation.apply(channels_from(6), noise);
  EXPECT_NEAR(noise(0, 0), 4.0, 1e-14);
  EXPECT_NEAR(noise(0, 1), std::sqrt(ratio), 1e-13);
  EXPECT_NEAR(noise(1, 0), std::sqrt(ratio), 1e-13);
  EXPECT_NEAR(noise(1, 1), 2.0 * ratio, 1e-12);
}

}  // namespace
}  // namespace palpate
