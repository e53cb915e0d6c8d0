// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/estimation/consistency.hpp>
#include <tests/estimation/linear_models.hpp>

namespace palpate {
namespace {

using test::Draws;

/// Abramowitz and Stegun, table 26.8, and any statistics book; five digits.
TEST(ChiSquare, TailQuantilesAreTheTabulatedOnes) {
  EXPECT_NEAR(chi_square_tail_quantile(0.05, 1), 3.8415, 1e-4);
  EXPECT_NEAR(chi_square_tail_quantile(0.05, 2), 5.9915, 1e-4);
  EXPECT_NEAR(chi_square_tail_quantile(0.05, 3), 7.8147, 1e-4);
  EXPECT_NEAR(chi_square_tail_quantile(0.05, 12), 21.0261, 1e-4);
  EXPECT_NEAR(chi_square_tail_quantile(0.01, 6), 16.8119, 1e-4);
  EXPECT_NEAR(chi_square_tail_quantile(0.001, 3), 16.2662, 1e-4);
  EXPECT_NEAR(chi_square_tail_quantile(0.95, 3), 0.3518, 1e-4);
  EXPECT_NEAR(chi_square_tail_quantile(0.5, 10), 9.3418, 1e-4);
}

/// For two degrees of freedom the tail is exp(-x / 2).
TEST(ChiSquare, FarTailIsExact) { EXPECT_NEAR(chi_square_tail_quantile(1e-6, 2), -2.0 * std::log(1e-6), 1e-9); }

TEST(ChiSquareGate, PassesUpToTheQuantileOfItsDegrees) {
  const ChiSquareGate gate(0.01);
  EXPECT_TRUE(gate.passes(16.8118, 6));
  EXPECT_FALSE(gate.passes(16.8120, 6));
  EXPECT_FALSE(gate.passes(std::nan(""), 6));
  EXPECT_TRUE(gate.passes(1e9, 0)) << "nothing to judge";
  for (int degrees = 1; degrees <= kMaxResiduals; ++degrees)
    EXPECT_DOUBLE_EQ(gate.threshold(degrees), chi_square_tail_quantile(0.01, degrees));
}

TEST(NormalisedErrorSquared, IsTheQuadraticForm) {
  Draws draws(51);
  for (int n = 1; n <= 6; ++n) {
    const Eigen::MatrixXd P = test::random_covariance(n, draws);
    const Eigen::VectorXd e = test::random_matrix(n, 1, draws);
    EXPECT_NEAR(normalised_error_squared(e, P), e.dot(P.inverse() * e), 1e-9);
  }
}

TEST(NormalisedErrorSquared, IsNaNWithoutADefiniteCovariance) {
  const StateVector e = Vector3d::Ones();
  EXPECT_TRUE(std::isnan(normalised_error_squared(e, -StateMatrix::Identity(3, 3))));
  EXPECT_TRUE(std::isnan(normalised_error_squared(e, StateMatrix::Zero(3, 3))));
}

/// rho = r^T S r, and r^T S^-1 r, with S = J P J^T + R.
TEST(ConvergenceIndex, BothFormsByHand) {
  ResidualVector r = Eigen::Vector2d(1.0, 2.0);
  JacobianMatrix J = Eigen::Vector2d(1.0, 1.0);
  StateMatrix P = StateMatrix::Constant(1, 1, 2.0);
  ResidualMatrix R = ResidualMatrix::Identity(2, 2);  // S = (3 2; 2 3), S^-1 = (3 -2; -2 3) / 5
  const ConvergenceIndex index = convergence_index(r, J, P, R);
  EXPECT_NEAR(index.paper, 3.0 + 8.0 + 12.0, 1e-14);
  EXPECT_NEAR(index.normalised, (3.0 - 8.0 + 12.0) / 5.0, 1e-14);
}

TEST(ConvergenceIndex, PapersFormHasUnitsAndTheNormalisedOneHasNot) {
  Draws draws(52);
  ResidualVector r = test::random_matrix(4, 1, draws);
  JacobianMatrix J = test::random_matrix(4, 3, draws);
  const StateMatrix P = test::random_covariance(3, draws);
  const ResidualMatrix R = test::random_covariance(4, draws);
  const ConvergenceIndex metres = convergence_index(r, J, P, R);
  const ConvergenceIndex millimetres = convergence_index(1e3 * r, 1e3 * J, P, 1e6 * R);
  EXPECT_NEAR(millimetres.normalised / metres.normalised, 1.0, 1e-9);
  EXPECT_NEAR(millimetres.paper / metres.paper, 1e12, 1e3);
}

/// Mean NEES and NIS after 30 steps over 200 runs of a random walk in 3-D seen through 4 rows. `claimed_R` scales what
/// the filter believes of the measurement noise.
struct Means {
  double nees = 0.0, nis = 0.0;
};

Means monte_carlo(double claimed_R) {
  constexpr int kRuns = 200, kSteps = 30;
  Means mean;
  Draws draws(53);
  const Eigen::MatrixXd H = test::random_matrix(4, 3, draws);
  for (int run = 0; run < kRuns; ++run) {
    Gaussian state{StateVector::Zero(3), StateMatrix::Identity(3, 3)};
    Eigen::Vector3d truth = draws.normal3();
    Update update;
    for (int step = 0; step < kSteps; ++step) {
      truth += 0.3 * draws.normal3();
      state.covariance.diagonal().array() += 0.09;
      test::LinearModel model{H, claimed_R * Eigen::MatrixXd::Identity(4, 4),
                              H * truth + test::random_matrix(4, 1, draws)};
      iterated_update(model, state, state.mean, {}, update);
      state = update.posterior;
    }
    mean.nees += normalised_error_squared(state.mean - truth, state.covariance) / kRuns;
    mean.nis += update.chi_square / kRuns;
  }
  return mean;
}

/// kRuns times the mean is chi-square of 200 x 3 (200 x 4) degrees: its 95 % band is [2.66, 3.36] ([3.62, 4.40]).
TEST(MonteCarlo, MatchedFilterIsConsistent) {
  const Means mean = monte_carlo(1.0);
  EXPECT_GT(mean.nees, chi_square_tail_quantile(0.975, 600) / 200);
  EXPECT_LT(mean.nees, chi_square_tail_quantile(0.025, 600) / 200);
  EXPECT_GT(mean.nis, chi_square_tail_quantile(0.975, 800) / 200);
  EXPECT_LT(mean.nis, chi_square_tail_quantile(0.025, 800) / 200);
}

TEST(MonteCarlo, WrongNoiseLeavesTheBandOnTheSideItShould) {
  EXPECT_GT(monte_carlo(0.3).nees, chi_square_tail_quantile(0.025, 600) / 200);
  EXPECT_GT(monte_carlo(0.3).nis, chi_square_tail_quantile(0.025, 800) / 200);
  EXPECT_LT(monte_carlo(3.0).nees, chi_square_tail_quantile(0.975, 600) / 200);
  EXPECT_LT(monte_carlo(3.0).nis, chi_square_tail_quantile(0.975, 800) / 200);
}

}  // namespace
}  // namespace palpate
