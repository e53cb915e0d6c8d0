// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tests/estimation/linear_models.hpp>

namespace palpate {
namespace {

using test::Draws;

StateVector state(std::initializer_list<double> values) {
  StateVector x(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), x.data());
  return x;
}

/// Distance to two beacons on the x axis: the state is a point in the plane.
struct Beacons {
  Eigen::Vector2d ranges;
  double sigma = 0.05;

  static Eigen::Vector2d range_of(double x, double y) { return {std::hypot(x + 1.0, y), std::hypot(x - 1.0, y)}; }
  int rows() const { return 2; }
  void noise(ResidualMatrix& R) const { R = sigma * sigma * ResidualMatrix::Identity(2, 2); }
  bool linearize(const StateVector& x, Linearization& at) {
    const Eigen::Vector2d h = range_of(x(0), x(1));
    at.residual = ranges - h;
    at.jacobian.resize(2, 2);
    at.jacobian << (x(0) + 1.0) / h(0), x(1) / h(0), (x(0) - 1.0) / h(1), x(1) / h(1);
    return h.minCoeff() > 0.0;
  }
};

double map_cost(const Beacons& model, const Gaussian& prior, const StateVector& x) {
  const Eigen::Vector2d dx = x - prior.mean;
  const Eigen::Vector2d r = model.ranges - Beacons::range_of(x(0), x(1));
  return dx.dot(Eigen::Matrix2d(prior.covariance).inverse() * dx) + r.squaredNorm() / (model.sigma * model.sigma);
}

/// Brute force: ever finer grids around the best point so far.
StateVector grid_minimum(const Beacons& model, const Gaussian& prior) {
  StateVector best = prior.mean;
  for (double half = 3.0; half > 1e-7; half *= 0.2) {
    const StateVector centre = best;
    double least = std::numeric_limits<double>::infinity();
    for (int i = -40; i <= 40; ++i)
      for (int j = -40; j <= 40; ++j) {
        const StateVector x = centre + half / 40.0 * Eigen::Vector2d(i, j);
        const double cost = map_cost(model, prior, x);
        if (cost < least) least = cost, best = x;
      }
  }
  return best;
}

struct Problem {
  Beacons model;
  Gaussian prior;
};

Problem random_problem(Draws& draws) {
  const Eigen::Vector2d truth(draws.uniform(-0.8, 0.8), draws.uniform(0.8, 2.0));
  const Eigen::Vector2d noise(0.05 * draws.normal(), 0.05 * draws.normal());
  return {{Beacons::range_of(truth.x(), truth.y()) + noise},
          {state({truth.x() + 0.3 * draws.normal(), truth.y() + 0.3 * draws.normal()}),
           0.09 * StateMatrix::Identity(2, 2)}};
}

/// Converged means: the step left is below 1e-2 (1e-5) posterior sigmas of at most 0.1.
TEST(NonlinearUpdate, IteratedUpdateFindsTheMaximumThatAGridFinds) {
  Draws draws(41);
  for (int trial = 0; trial < 20; ++trial) {
    Problem p = random_problem(draws);
    const StateVector best = grid_minimum(p.model, p.prior);
    Update loose, tight;
    iterated_update(p.model, p.prior, p.prior.mean, {.max_iterations = 50}, loose);
    iterated_update(p.model, p.prior, p.prior.mean, {.max_iterations = 50, .step_tolerance = 1e-5}, tight);
    EXPECT_EQ(loose.status, UpdateStatus::kConverged);
    EXPECT_EQ(tight.status, UpdateStatus::kConverged);
    EXPECT_LT((loose.posterior.mean - best).norm(), 1e-3);
    EXPECT_LT((tight.posterior.mean - best).norm(), 1e-6);
    EXPECT_NEAR(tight.chi_square, map_cost(p.model, p.prior, best), 1e-6);
  }
}

TEST(NonlinearUpdate, AnotherStartGivesTheSameOptimum) {
  Draws draws(42);
  for (int trial = 0; trial < 20; ++trial) {
    Problem p = random_problem(draws);
    Update from_prior, from_elsewhere;
    const UpdateOptions options{.max_iterations = 50, .step_tolerance = 1e-5};
    iterated_update(p.model, p.prior, p.prior.mean, options, from_prior);
    iterated_update(p.model, p.prior, state({draws.uniform(-1, 1), draws.uniform(1, 3)}), options, from_elsewhere);
    EXPECT_LT((from_prior.posterior.mean - from_elsewhere.posterior.mean).norm(), 1e-6);
    EXPECT_LT((from_prior.posterior.covariance - from_elsewhere.posterior.covariance).norm(), 1e-6);
  }
}

TEST(NonlinearUpdate, CostAtTheEndIsNeverAboveThatAtTheStart) {
  Draws draws(43);
  for (int trial = 0; trial < 200; ++trial) {
    Problem p = random_problem(draws);
    p.prior.covariance *= 100.0;  // far from convex
    const StateVector start = state({draws.uniform(-3, 3), draws.uniform(-3, 3)});
    for (const int iterations : {1, 2, 5, 50}) {
      Update update;
      iterated_update(p.model, p.prior, start, {.max_iterations = iterations}, update);
      ASSERT_NE(update.status, UpdateStatus::kFailed);
      EXPECT_LE(map_cost(p.model, p.prior, update.posterior.mean), map_cost(p.model, p.prior, start) * (1.0 + 1e-6));
      EXPECT_LE(update.evaluations, 1 + iterations);
    }
  }
}

TEST(NonlinearUpdate, IterationsThatRunOutAreReportedAndTheBestIterateIsGiven) {
  Problem p{{Beacons::range_of(0.5, 1.0)}, {state({-2.0, 4.0}), StateMatrix::Identity(2, 2)}};
  Update update;
  iterated_update(p.model, p.prior, p.prior.mean, {.max_iterations = 1, .step_tolerance = 1e-9}, update);
  EXPECT_EQ(update.status, UpdateStatus::kNotConverged);
  EXPECT_LT(map_cost(p.model, p.prior, update.posterior.mean), map_cost(p.model, p.prior, p.prior.mean));
}

TEST(NonlinearUpdate, ExtendedUpdateIsOneGaussNewtonStep) {
  Draws draws(44);
  Problem p = random_problem(draws);
  Linearization at;
  p.model.linearize(p.prior.mean, at);
  const test::LinearModel linear{at.jacobian, p.model.sigma * p.model.sigma * Eigen::Matrix2d::Identity(),
                                 at.residual + at.jacobian * p.prior.mean};
  const test::Textbook expected = test::textbook_update(linear, p.prior);
  Update update;
  extended_update(p.model, p.prior, update);
  EXPECT_LT((update.posterior.mean - expected.mean).norm(), 1e-12);
  EXPECT_LT((update.posterior.covariance - expected.covariance).norm(), 1e-12);
  EXPECT_NEAR(update.chi_square, expected.nis, 1e-9 * expected.nis);
  EXPECT_EQ(update.evaluations, 2);
}

/// log x, known where x > 0 only.
struct Logarithm {
  double y = 0.0;
  int rows() const { return 1; }
  void noise(ResidualMatrix& R) const { R = ResidualMatrix::Constant(1, 1, 0.01); }
  bool linearize(const StateVector& x, Linearization& at) {
    at.residual = StateVector::Constant(1, y - std::log(x(0)));
    at.jacobian = JacobianMatrix::Constant(1, 1, 1.0 / x(0));
    return std::isfinite(at.residual(0));
  }
};

TEST(NonlinearUpdate, NoFiniteModelAtTheStartFailsAndThePosteriorIsThePrior) {
  Logarithm model;
  const Gaussian prior{state({-1.0}), StateMatrix::Identity(1, 1)};
  for (const bool iterated : {true, false}) {
    Update update;
    iterated ? iterated_update(model, prior, prior.mean, {}, update) : extended_update(model, prior, update);
    EXPECT_EQ(update.status, UpdateStatus::kFailed);
    EXPECT_EQ(update.posterior.mean, prior.mean);
    EXPECT_EQ(update.posterior.covariance, prior.covariance);
    EXPECT_EQ(update.evaluations, 1);
  }
}

/// The full step from x = 3 leads to negative x; halving must bring it back.
TEST(NonlinearUpdate, AStepOutOfTheModelsRangeIsHalved) {
  Logarithm model{.y = std::log(0.1)};
  const Gaussian prior{state({3.0}), StateMatrix::Constant(1, 1, 100.0)};
  Update update;
  iterated_update(model, prior, prior.mean, {.max_iterations = 50, .step_tolerance = 1e-4}, update);
  EXPECT_EQ(update.status, UpdateStatus::kConverged);
  EXPECT_NEAR(update.posterior.mean(0), 0.1, 0.01);
}

TEST(NonlinearUpdate, ExtendedUpdateSaysWhereItsStepLeftTheModelsRange) {
  Logarithm model{.y = std::log(0.1)};
  const Gaussian prior{state({3.0}), StateMatrix::Constant(1, 1, 100.0)};
  Update update;
  extended_update(model, prior, update);
  EXPECT_EQ(update.status, UpdateStatus::kNotConverged);
}

/// The iteration as the paper writes it, in the state's own coordinates and with plain inverses:
/// x <- x0 + K (y - h(x) - H (x0 - x)),  K = P H^T (H P H^T + R)^-1.
StateVector gauss_newton(Beacons model, const Gaussian& prior, StateVector x, int iterations) {
  const Eigen::Matrix2d P = prior.covariance, R = model.sigma * model.sigma * Eigen::Matrix2d::Identity();
  for (int i = 0; i < iterations; ++i) {
    Linearization at;
    model.linearize(x, at);
    const Eigen::Matrix2d H = at.jacobian;
    const Eigen::Matrix2d K = P * H.transpose() * (H * P * H.transpose() + R).inverse();
    const Eigen::Vector2d r = at.residual, dx = prior.mean - x;
    x = prior.mean + K * (r - H * dx);
  }
  return x;
}

TEST(NonlinearUpdate, UndampedOptionIsGaussNewtonStepByStep) {
  Draws draws(45);
  for (int trial = 0; trial < 20; ++trial) {
    Problem p = random_problem(draws);
    const StateVector start = state({draws.uniform(-1, 1), draws.uniform(1, 3)});
    for (int iterations = 1; iterations <= 6; ++iterations) {
      Update update;
      const UpdateOptions options{.max_iterations = iterations, .step_tolerance = 1e-30, .damping = Damping::kNone};
      iterated_update(p.model, p.prior, start, options, update);
      const StateVector expected = gauss_newton(p.model, p.prior, start, iterations);
      EXPECT_LT((update.posterior.mean - expected).norm(), 1e-10 * (1.0 + expected.norm())) << iterations;
      EXPECT_EQ(update.evaluations, 1 + iterations);
    }
  }
}

/// y = atan x: Newton's iteration flies off from beyond 1.39, farther with every step.
struct Arctangent {
  int rows() const { return 1; }
  void noise(ResidualMatrix& R) const { R = ResidualMatrix::Constant(1, 1, 1e-4); }
  bool linearize(const StateVector& x, Linearization& at) {
    at.residual = StateVector::Constant(1, -std::atan(x(0)));
    at.jacobian = JacobianMatrix::Constant(1, 1, 1.0 / (1.0 + x(0) * x(0)));
    return true;
  }
};

TEST(NonlinearUpdate, UndampedOptionDivergesWhereTheDampedOneConverges) {
  Arctangent model;
  const Gaussian prior{state({2.5}), StateMatrix::Constant(1, 1, 1e12)};
  Update damped, undamped;
  iterated_update(model, prior, prior.mean, {.max_iterations = 30}, damped);
  EXPECT_EQ(damped.status, UpdateStatus::kConverged);
  EXPECT_NEAR(damped.posterior.mean(0), 0.0, 1e-4);
  double last = 2.5;
  for (const int iterations : {1, 2, 3, 4}) {
    iterated_update(model, prior, prior.mean, {.max_iterations = iterations, .damping = Damping::kNone}, undamped);
    EXPECT_EQ(undamped.status, UpdateStatus::kNotConverged);
    EXPECT_GT(std::abs(undamped.posterior.mean(0)), 2.0 * last);
    EXPECT_EQ(undamped.evaluations, 1 + iterations);
    last = std::abs(undamped.posterior.mean(0));
  }
}

}  // namespace
}  // namespace palpate
