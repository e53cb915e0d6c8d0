// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <palpate/estimation/unscented.hpp>
#include <tests/estimation/linear_models.hpp>
#include <tests/observer/allocation_counter.hpp>

namespace palpate {
namespace {

using test::Draws;
using test::LinearModel;

/// Random well-conditioned matrices of at most 6 x 12: rounding stays below 1e-12 of the numbers' size.
constexpr double kRounding = 1e-10;

void expect_symmetric_definite(const StateMatrix& P) {
  EXPECT_EQ(P, StateMatrix(P.transpose()));
  EXPECT_EQ(Eigen::LLT<StateMatrix>(P).info(), Eigen::Success) << P;
}

TEST(UnscentedUpdate, EqualsTheTextbookOnALinearModel) {
  Draws draws(61);
  for (int trial = 0; trial < 100; ++trial) {
    const int states = 1 + trial % 6, rows = 1 + trial % 12;
    LinearModel model = test::random_linear_model(states, rows, draws);
    const Gaussian prior = test::random_prior(states, draws);
    const test::Textbook expected = test::textbook_update(model, prior);
    Update update;
    unscented_update(model, prior, update);
    EXPECT_EQ(update.status, UpdateStatus::kConverged);
    EXPECT_EQ(update.rows, rows);
    EXPECT_LT((update.posterior.mean - expected.mean).norm(), kRounding);
    EXPECT_LT((update.posterior.covariance - expected.covariance).norm(), kRounding);
    EXPECT_NEAR(update.chi_square, expected.nis, kRounding * (1.0 + expected.nis));
    EXPECT_LT((update.innovation - (model.y - model.H * prior.mean)).norm(), kRounding);
    const Eigen::VectorXd r = model.y - model.H * expected.mean;
    const double misfit = r.dot(model.R.inverse() * r);
    EXPECT_NEAR(update.residual_chi_square, misfit, kRounding * (1.0 + misfit));
    EXPECT_LT((update.at.residual - r).norm(), kRounding);
    EXPECT_EQ(update.at.jacobian, model.H);
  }
}

/// Sigmas 1e6 and 1e-6 side by side: P - K S K^T would cancel to noise.
TEST(UnscentedUpdate, CovarianceIsRightOverTwelveOrdersOfMagnitude) {
  LinearModel model{Eigen::MatrixXd::Identity(2, 2), Eigen::Vector2d(1e-12, 1.0).asDiagonal(), Eigen::Vector2d(1, 1)};
  const Gaussian prior{Eigen::Vector2d::Zero(), Eigen::Vector2d(1e12, 1e-12).asDiagonal()};
  Update update;
  unscented_update(model, prior, update);
  EXPECT_NEAR(update.posterior.covariance(0, 0) / 1e-12, 1.0, 1e-3);
  EXPECT_NEAR(update.posterior.covariance(1, 1) / 1e-12, 1.0, 1e-3);
}

/// y_i = a_i + b_i x_i + c_i x_i^2 + w_i, three independent channels.
struct Parabolas {
  Eigen::Vector3d a, b, c, y, variance;
  int calls = 0;

  int rows() const { return 3; }
  void noise(ResidualMatrix& R) const { R = variance.asDiagonal(); }
  bool linearize(const StateVector& x, Linearization& at) {
    ++calls;
    const Eigen::Array3d xs = x;
    at.residual = (y.array() - a.array() - b.array() * xs - c.array() * xs.square()).matrix();
    at.jacobian = (b.array() + 2.0 * c.array() * xs).matrix().asDiagonal();
    return true;
  }
};

Parabolas random_parabolas(Draws& draws) {
  return {draws.normal3(), draws.normal3(), draws.normal3(), draws.normal3(), draws.normal3().cwiseAbs2()};
}

/// With independent states the moments that the linear estimator needs are, for x ~ N(x0, p) and slope s = b + 2 c x0:
/// E y = a + b x0 + c (x0^2 + p), cov(x, y) = s p, var y = s^2 p + 2 c^2 p^2 + R. Three states: the points carry the
/// fourth moment along each axis, though not how the squares of two states go together. Hence one channel at a time is
/// bent and the others are straight.
TEST(UnscentedUpdate, HasTheExactMomentsOfAParabola) {
  Draws draws(62);
  for (int trial = 0; trial < 60; ++trial) {
    Parabolas model = random_parabolas(draws);
    const int bent = trial % 3;
    for (int i = 0; i < 3; ++i) model.c(i) *= i == bent ? 1.0 : 0.0;
    const Eigen::Vector3d x0 = draws.normal3(), p = draws.normal3().cwiseAbs2();
    const Gaussian prior{x0, p.asDiagonal()};
    Update update;
    unscented_update(model, prior, update);
    double nis = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double slope = model.b(i) + 2.0 * model.c(i) * x0(i), c = model.c(i);
      const double nu = model.y(i) - model.a(i) - model.b(i) * x0(i) - c * (x0(i) * x0(i) + p(i));
      const double S = slope * slope * p(i) + 2.0 * c * c * p(i) * p(i) + model.variance(i);
      EXPECT_NEAR(update.innovation(i), nu, kRounding * (1.0 + std::abs(nu)));
      const double mean = x0(i) + slope * p(i) / S * nu, variance = p(i) - slope * slope * p(i) * p(i) / S;
      EXPECT_NEAR(update.posterior.mean(i), mean, kRounding * (1.0 + std::abs(mean)));
      EXPECT_NEAR(update.posterior.covariance(i, i), variance, kRounding);
      nis += nu * nu / S;
    }
    EXPECT_NEAR(update.chi_square, nis, kRounding * (1.0 + nis));
  }
}

/// Distance to a beacon at the origin: in one direction across the line of sight the prior is wide, and there the
/// distance only grows. (In two, the points would miss how the squares of two states go together.)
struct Range {
  double y = 0.0;
  static constexpr double kSigma = 0.05;

  int rows() const { return 1; }
  void noise(ResidualMatrix& R) const { R.setConstant(1, 1, kSigma * kSigma); }
  bool linearize(const StateVector& x, Linearization& at) {
    at.residual.setConstant(1, y - x.norm());
    at.jacobian = x.normalized().transpose();
    return true;
  }
};

Gaussian wide_across() { return {Eigen::Vector3d(1.0, 0.0, 0.0), Eigen::Vector3d(0.01, 0.09, 0.0025).asDiagonal()}; }

/// Posterior mean by the sum over a grid of +-5 prior sigmas, 0.2 sigma apart: the integrand is smooth, and dead at
/// both ends, hence far more exact than the 1e-2 that matters here.
StateVector by_grid(const Range& model, const Gaussian& prior) {
  constexpr int kHalf = 25;
  const Eigen::Vector3d sigma = prior.covariance.diagonal().cwiseSqrt();
  double total = 0.0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = -kHalf; i <= kHalf; ++i)
    for (int j = -kHalf; j <= kHalf; ++j)
      for (int k = -kHalf; k <= kHalf; ++k) {
        const Eigen::Vector3d z = 0.2 * Eigen::Vector3d(i, j, k), x = prior.mean + sigma.cwiseProduct(z);
        const double r = (model.y - x.norm()) / Range::kSigma;
        const double weight = std::exp(-0.5 * (z.squaredNorm() + r * r));
        total += weight;
        sum += weight * x;
      }
  return sum / total;
}

/// A distance as the prior and the noise make it, with the true state.
struct Drawn {
  StateVector truth;
  Range model;
};

Drawn drawn(const Gaussian& prior, Draws& draws) {
  const Eigen::Vector3d sigma = prior.covariance.diagonal().cwiseSqrt();
  const StateVector truth = prior.mean + sigma.cwiseProduct(draws.normal3());
  return {truth, {truth.norm() + Range::kSigma * draws.normal()}};
}

/// The distances that the prior expects lie about 1.046, but the tangent at the mean says 1: most of the error is in
/// not knowing that. What a straight line can do at best is left.
TEST(UnscentedUpdate, IsNearerToTheTruePosteriorMeanThanTheExtendedUpdate) {
  Draws draws(63);
  constexpr int kTrials = 60;
  const Gaussian prior = wide_across();
  double extended_error = 0.0, unscented_error = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Range model = drawn(prior, draws).model;
    const StateVector exact = by_grid(model, prior);
    Update extended, unscented;
    extended_update(model, prior, extended);
    unscented_update(model, prior, unscented);
    extended_error += (extended.posterior.mean - exact).squaredNorm() / kTrials;
    unscented_error += (unscented.posterior.mean - exact).squaredNorm() / kTrials;
  }
  EXPECT_GT(std::sqrt(extended_error), 0.03);
  EXPECT_LT(std::sqrt(unscented_error), 0.5 * std::sqrt(extended_error));
}

/// Truth from the prior, measurement from the truth: the mean normalised error squared is 3, its own sigma
/// sqrt(6 / 4000); that of the innovation is 1. 3 % for the expansion of the distance beyond its second order.
TEST(UnscentedUpdate, SaysHowWrongItIsWhereTheExtendedUpdateIsTooSure) {
  Draws draws(64);
  constexpr int kTrials = 4000;
  const Gaussian prior = wide_across();
  double extended_sum = 0.0, unscented_sum = 0.0, nis_sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    auto [truth, model] = drawn(prior, draws);
    Update extended, unscented;
    extended_update(model, prior, extended);
    unscented_update(model, prior, unscented);
    const auto nees = [&, &truth = truth](const Gaussian& posterior) {
      const StateVector error = truth - posterior.mean;
      return error.dot(Eigen::LLT<StateMatrix>(posterior.covariance).solve(error));
    };
    extended_sum += nees(extended.posterior) / kTrials;
    unscented_sum += nees(unscented.posterior) / kTrials;
    nis_sum += unscented.chi_square / kTrials;
  }
  EXPECT_GT(extended_sum, 4.0);
  EXPECT_NEAR(unscented_sum, 3.0, 4.0 * std::sqrt(6.0 / kTrials));
  EXPECT_NEAR(nis_sum, 1.0, 4.0 * std::sqrt(2.0 / kTrials) + 0.03);
}

/// A heading: the residual is wrapped, so that a straight model stays straight across the cut at pi.
struct Compass {
  double heading = 0.0;

  static double wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }
  int rows() const { return 1; }
  void noise(ResidualMatrix& R) const { R.setConstant(1, 1, 0.01); }
  bool linearize(const StateVector& x, Linearization& at) {
    at.residual.setConstant(1, wrapped(heading - wrapped(x(0))));
    at.jacobian.setConstant(1, 1, 1.0);
    return true;
  }
};

TEST(UnscentedUpdate, AveragesResidualsWhichMayWrapAndNotMeasurements) {
  const Gaussian prior{StateVector::Constant(1, -std::numbers::pi + 0.05), StateMatrix::Constant(1, 1, 0.04)};
  Compass model{std::numbers::pi - 0.05};
  Update update;
  unscented_update(model, prior, update);
  EXPECT_NEAR(update.innovation(0), -0.1, 1e-12);
  EXPECT_NEAR(update.posterior.mean(0), prior.mean(0) - 0.1 * 0.04 / (0.04 + 0.01), 1e-12);
  EXPECT_NEAR(update.posterior.covariance(0, 0), 0.04 * 0.01 / (0.04 + 0.01), 1e-12);
}

/// y = H x + |x|^2 c: bent as much as it likes.
struct Bent {
  LinearModel straight;
  Eigen::VectorXd c;

  int rows() const { return straight.rows(); }
  void noise(ResidualMatrix& R) const { straight.noise(R); }
  bool linearize(const StateVector& x, Linearization& at) {
    straight.linearize(x, at);
    at.residual -= x.squaredNorm() * c;
    at.jacobian += 2.0 * c * x.transpose();
    return true;
  }
};

Eigen::VectorXd random_scales(int n, double decades, Draws& draws) {
  return Eigen::VectorXd::NullaryExpr(n,
                                      [&](Eigen::Index) { return std::pow(10.0, draws.uniform(-decades, decades)); });
}

/// Prior and noise of a condition up to 1e12, scales of the states apart by up to 1e12, sensors a million times better
/// than the prior: the factorisation that the next update begins with must succeed.
TEST(UnscentedUpdate, CovarianceIsSymmetricAndDefiniteInHardCases) {
  Draws draws(65);
  for (int trial = 0; trial < 2000; ++trial) {
    const int states = 1 + trial % 8, rows = 1 + trial % 13;
    Bent model{test::random_linear_model(states, rows, draws), 100.0 * test::random_matrix(rows, 1, draws)};
    Gaussian prior = test::random_prior(states, draws);
    const Eigen::MatrixXd D = random_scales(states, 3.0, draws).asDiagonal();
    const Eigen::MatrixXd E = random_scales(rows, 3.0, draws).asDiagonal();
    prior.covariance = D * Eigen::MatrixXd(prior.covariance) * D;
    model.straight.R = 1e-12 * E * model.straight.R * E;
    if (trial % 2 == 0) model.c.setZero();
    Update update;
    unscented_update(model, prior, update);
    ASSERT_EQ(update.status, UpdateStatus::kConverged);
    expect_symmetric_definite(update.posterior.covariance);
  }
}

/// The sum of all states is known to 1e-12 of their sigma: in double precision nothing is left of its variance.
TEST(UnscentedUpdate, CovarianceIsDefiniteWhereASumOfStatesIsPinnedDown) {
  Draws draws(66);
  for (int states = 2; states <= kMaxStates; ++states)
    for (int trial = 0; trial < 50; ++trial) {
      LinearModel model{Eigen::MatrixXd::Ones(1, states), Eigen::MatrixXd::Constant(1, 1, 1e-24),
                        Eigen::VectorXd::Constant(1, 1.0)};
      const Gaussian prior = test::random_prior(states, draws);
      Update update;
      unscented_update(model, prior, update);
      ASSERT_EQ(update.status, UpdateStatus::kConverged);
      expect_symmetric_definite(update.posterior.covariance);
    }
}

template <class Model>
void expect_failed(Model model, const Gaussian& prior, int evaluations) {
  Update update;
  update.chi_square = update.residual_chi_square = 7.0;  // of an earlier update
  unscented_update(model, prior, update);
  EXPECT_EQ(update.status, UpdateStatus::kFailed);
  EXPECT_EQ(update.evaluations, evaluations);
  EXPECT_EQ(update.chi_square, 0.0);
  EXPECT_EQ(update.residual_chi_square, 0.0);
  const auto same = [](const auto& a, const auto& b) { return ((a.array() == b.array()) || a.array().isNaN()).all(); };
  EXPECT_TRUE(same(update.posterior.mean, prior.mean));
  EXPECT_TRUE(same(update.posterior.covariance, prior.covariance));
}

TEST(UnscentedUpdate, LostDefinitenessFailsAndThePosteriorIsThePrior) {
  Draws draws(67);
  const LinearModel good = test::random_linear_model(2, 3, draws);
  const Gaussian prior = test::random_prior(2, draws);
  LinearModel no_noise = good;
  no_noise.R = -no_noise.R;
  expect_failed(no_noise, prior, 0);
  no_noise.R.setConstant(std::numeric_limits<double>::quiet_NaN());
  expect_failed(no_noise, prior, 0);
  Gaussian lost = prior;
  lost.covariance(0, 0) = -1.0;
  expect_failed(good, lost, 0);
  lost.covariance(0, 0) = std::numeric_limits<double>::quiet_NaN();
  expect_failed(good, lost, 0);
}

/// log x, known where x > 0 only, which it says in one of two ways: by its return value or by NaN.
struct Logarithm {
  double y = 0.0;
  bool returns_false = true;

  int rows() const { return 1; }
  void noise(ResidualMatrix& R) const { R.setConstant(1, 1, 1e-4); }
  bool linearize(const StateVector& x, Linearization& at) {
    const bool known = x(0) > 0.0;
    at.residual.setConstant(1, y - std::log(known || !returns_false ? x(0) : 1.0));
    at.jacobian.setConstant(1, 1, 1.0 / x(0));
    return known || !returns_false;
  }
};

Gaussian one_state(double mean, double sigma) {
  return {StateVector::Constant(1, mean), StateMatrix::Constant(1, 1, sigma * sigma)};
}

TEST(UnscentedUpdate, NoFiniteModelAtASigmaPointFailsAndThePosteriorIsThePrior) {
  for (const bool returns_false : {true, false}) {
    expect_failed(Logarithm{0.0, returns_false}, one_state(-3.0, 1.0), 1);  // nowhere
    expect_failed(Logarithm{0.0, returns_false}, one_state(1.0, 1.5), 2);   // not at the second point
  }
}

TEST(UnscentedUpdate, OverflowFailsAndThePosteriorIsThePrior) {
  LinearModel model{Eigen::MatrixXd::Constant(1, 1, 1e200), Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Ones(1)};
  expect_failed(model, one_state(0.0, 1.0), 2);  // innovation 1, S_yy infinite
}

/// Steep near 1, flat at the far point: the step overshoots to negative x.
TEST(UnscentedUpdate, SaysWhereItsStepLeftTheModelsRange) {
  for (const bool returns_false : {true, false}) {
    Logarithm model{-6.0, returns_false};
    Update update;
    unscented_update(model, one_state(1.0, 0.9), update);
    EXPECT_EQ(update.status, UpdateStatus::kNotConverged);
    EXPECT_LT(update.posterior.mean(0), 0.0);
    EXPECT_EQ(update.evaluations, 3);
    expect_symmetric_definite(update.posterior.covariance);
  }
}

TEST(UnscentedUpdate, TakesTwoEvaluationsAStateAndOneMore) {
  Draws draws(68);
  Parabolas model = random_parabolas(draws);
  Update update;
  unscented_update(model, test::random_prior(3, draws), update);
  EXPECT_EQ(update.evaluations, 7);
  EXPECT_EQ(model.calls, 7);
}

/// A linear model of full size whose own matrices have a fixed capacity.
struct FullSize {
  JacobianMatrix H;
  ResidualMatrix R;
  ResidualVector y;

  int rows() const { return static_cast<int>(y.size()); }
  void noise(ResidualMatrix& out) const { out = R; }
  bool linearize(const StateVector& x, Linearization& at) {
    at.residual = y - H.lazyProduct(x);
    at.jacobian = H;
    return true;
  }
};

TEST(UnscentedUpdate, DoesNotAllocateAtAnySizeAndIsRightAtTheLargest) {
  Draws draws(69);
  for (const auto& [states, rows] : {std::pair(1, 1), std::pair(3, 12), std::pair(kMaxStates, kMaxResiduals)}) {
    const LinearModel linear = test::random_linear_model(states, rows, draws);
    FullSize model{linear.H, linear.R, linear.y};
    const Gaussian prior = test::random_prior(states, draws);
    Update update;
    const test::CountAllocations count;
    unscented_update(model, prior, update);
    EXPECT_EQ(count.so_far(), 0U) << states << " states, " << rows << " rows";
    EXPECT_LT((update.posterior.mean - test::textbook_update(linear, prior).mean).norm(), 1e-8);
  }
}

}  // namespace
}  // namespace palpate
