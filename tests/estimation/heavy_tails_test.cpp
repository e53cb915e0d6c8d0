// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tests/estimation/linear_models.hpp>

/// Noise with a Gaussian core and a Student t tail, block by block, on linear models: the robust cost is written down
/// and searched by brute force.
namespace palpate {
namespace {

using test::Draws;

constexpr int kBlock = 3;  ///< rows

struct Blocks : test::LinearModel {
  int block_end(int row) const { return (row / kBlock + 1) * kBlock; }
};
static_assert(BlockModel<Blocks>);

/// Sensors of three rows with covariances of their own, independent of each other; the data of the truth x = 0.
Blocks random_blocks(int sensors, Draws& draws) {
  const int rows = sensors * kBlock;
  Blocks model{{test::random_matrix(rows, 2, draws), Eigen::MatrixXd::Zero(rows, rows), Eigen::VectorXd::Zero(rows)}};
  for (int row = 0; row < rows; row += kBlock) {
    const Eigen::Matrix3d R = test::random_covariance(kBlock, draws);
    model.R.block<kBlock, kBlock>(row, row) = R;
    model.y.segment<kBlock>(row) = R.llt().matrixL() * draws.normal3();
  }
  return model;
}

double squared_distance(const Blocks& model, const Eigen::Vector2d& x, int row) {
  const Eigen::Vector3d r = (model.y - model.H * x).segment<kBlock>(row);
  return r.dot(Eigen::Matrix3d(model.R.block<kBlock, kBlock>(row, row)).inverse() * r);
}

double block_cost(double d2, double nu) {
  return d2 <= kBlock ? d2 : kBlock + (nu + kBlock) * std::log((nu + d2) / (nu + kBlock));
}

double robust_cost(const Blocks& model, const Gaussian& prior, const Eigen::Vector2d& x, double nu) {
  const Eigen::Vector2d dx = x - prior.mean;
  double cost = dx.dot(Eigen::Matrix2d(prior.covariance).inverse() * dx);
  for (int row = 0; row < model.rows(); row += kBlock) cost += block_cost(squared_distance(model, x, row), nu);
  return cost;
}

/// Ever finer grids around the best point so far.
Eigen::Vector2d grid_minimum(const Blocks& model, const Gaussian& prior, double nu) {
  Eigen::Vector2d best = Eigen::Vector2d::Zero();
  for (double half = 3.0; half > 1e-6; half *= 0.25) {
    const Eigen::Vector2d centre = best;
    double least = std::numeric_limits<double>::infinity();
    for (int i = -20; i <= 20; ++i)
      for (int j = -20; j <= 20; ++j) {
        const Eigen::Vector2d x = centre + half / 20.0 * Eigen::Vector2d(i, j);
        const double cost = robust_cost(model, prior, x, nu);
        if (cost < least) least = cost, best = x;
      }
  }
  return best;
}

Gaussian wide_prior() { return {Eigen::Vector2d(0.2, -0.1), 4.0 * StateMatrix::Identity(2, 2)}; }

Update update_of(Blocks model, const Gaussian& prior, double nu) {
  Update update;
  iterated_update(model, prior, prior.mean, {.max_iterations = 100, .step_tolerance = 1e-5, .tail_degrees = nu},
                  update);
  return update;
}

/// Shifts a sensor by so many of its sigmas along each of its principal axes.
Blocks with_outlier(Blocks model, int row, double sigmas) {
  const Eigen::Matrix3d W = model.R.block<kBlock, kBlock>(row, row).llt().matrixL();
  model.y.segment<kBlock>(row) += sigmas * W * Eigen::Vector3d::Ones();
  return model;
}

TEST(HeavyTails, UpdateFindsTheMinimumOfTheRobustCost) {
  Draws draws(81);
  for (int trial = 0; trial < 30; ++trial) {
    const double nu = trial % 2 == 0 ? 4.0 : 1.0;
    const Blocks model = with_outlier(random_blocks(4, draws), kBlock, trial % 3 == 0 ? 8.0 : 0.0);
    const Gaussian prior = wide_prior();
    const Eigen::Vector2d best = grid_minimum(model, prior, nu);
    const Update update = update_of(model, prior, nu);
    EXPECT_EQ(update.status, UpdateStatus::kConverged);
    EXPECT_LT((update.posterior.mean - best).norm(), 1e-5) << trial;
    EXPECT_NEAR(update.chi_square, robust_cost(model, prior, best, nu), 1e-6);
    double misfit = 0.0;
    for (int row = 0; row < model.rows(); row += kBlock) misfit += squared_distance(model, best, row);
    EXPECT_NEAR(update.residual_chi_square, misfit, 1e-3 * misfit) << "unweighted";
  }
}

/// P^-1 + sum_b w_b H_b^T R_b^-1 H_b with w = min(1, (nu + m) / (nu + d^2)): d rho / d(d^2) of the cost above.
TEST(HeavyTails, CovarianceCountsEachBlockWithItsWeight) {
  Draws draws(82);
  for (int trial = 0; trial < 10; ++trial) {
    const Blocks model = with_outlier(random_blocks(4, draws), 0, 10.0);
    const Gaussian prior = wide_prior();
    const Update update = update_of(model, prior, 4.0);
    Eigen::Matrix2d information = Eigen::Matrix2d(prior.covariance).inverse();
    for (int row = 0; row < model.rows(); row += kBlock) {
      const Eigen::MatrixXd H = model.H.middleRows(row, kBlock), R = model.R.block(row, row, kBlock, kBlock);
      const double weight = std::min(1.0, (4.0 + kBlock) / (4.0 + squared_distance(model, update.posterior.mean, row)));
      information += weight * H.transpose() * R.inverse() * H;
    }
    EXPECT_LT((update.posterior.covariance * information - Eigen::Matrix2d::Identity()).norm(), 1e-4);
  }
}

/// 30 sigma along each axis: d^2 = 2700 and a weight of 7 / 2704 = 0.26 %. The Gaussian shift is that of a full weight,
/// diluted by the outlier's own leverage, at worst about tenfold for these matrices.
TEST(HeavyTails, OutlyingBlockMovesTheEstimateByLessThanFivePercentOfWhatItWouldOtherwise) {
  Draws draws(83);
  for (int trial = 0; trial < 30; ++trial) {
    const Blocks clean = random_blocks(6, draws), dirty = with_outlier(clean, (trial % 6) * kBlock, 30.0);
    const Gaussian prior = wide_prior();
    Blocks without = clean;  // the outlier's sensor says nothing
    without.H.middleRows((trial % 6) * kBlock, kBlock).setZero();
    const auto moved = [&](double nu) {
      return (update_of(dirty, prior, nu).posterior.mean - update_of(without, prior, nu).posterior.mean).norm();
    };
    EXPECT_LT(moved(4.0), 0.05 * moved(0.0)) << trial;
  }
}

/// Weights scatter about 1 by (m - d^2) / (nu + d^2): with nu = 100 by a few percent. Measured: 0.24 and 0.017 sigma,
/// rms.
TEST(HeavyTails, WithoutOutliersTheAnswerIsNearlyTheGaussianOne) {
  Draws draws(84);
  double mean4 = 0.0, mean100 = 0.0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Blocks model = random_blocks(6, draws);
    const Gaussian prior = wide_prior();
    const Update gaussian = update_of(model, prior, 0.0);
    const auto squared_sigmas = [&](double nu) {
      const Eigen::Vector2d d = update_of(model, prior, nu).posterior.mean - gaussian.posterior.mean;
      return d.dot(Eigen::Matrix2d(gaussian.posterior.covariance).inverse() * d) / 2.0;
    };
    mean4 += squared_sigmas(4.0) / kTrials;
    mean100 += squared_sigmas(100.0) / kTrials;
  }
  EXPECT_LT(std::sqrt(mean4), 0.4);
  EXPECT_LT(std::sqrt(mean100), 0.03);
}

TEST(HeavyTails, ModelWithoutBlocksStaysGaussian) {
  Draws draws(85);
  test::LinearModel model = test::random_linear_model(2, 6, draws);
  static_assert(!BlockModel<test::LinearModel>);
  Update plain, tail;
  const Gaussian prior = wide_prior();
  iterated_update(model, prior, prior.mean, {}, plain);
  iterated_update(model, prior, prior.mean, {.tail_degrees = 4.0}, tail);
  EXPECT_EQ(plain.posterior.mean, tail.posterior.mean);
  EXPECT_EQ(plain.chi_square, tail.chi_square);
}

}  // namespace
}  // namespace palpate
