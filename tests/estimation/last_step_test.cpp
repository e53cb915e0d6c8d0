// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tests/estimation/linear_models.hpp>

/// When an iteration may stop, what it then leaves, and when it is not worth going on.
namespace palpate {
namespace {

using test::Draws;

TEST(StoppingRule, BelowTheToleranceNoHistoryIsNeeded) {
  const detail::StoppingRule rule(0.02);
  EXPECT_TRUE(rule.last(0.02));
  EXPECT_FALSE(rule.last(0.021));
}

/// theta = 0.3 / 6 = 1/20: theta / (1 - theta) 0.3 = 0.0158; with 0.35 it is 0.0217.
TEST(StoppingRule, TheErrorLeftIsThatOfAGeometricSeries) {
  detail::StoppingRule rule(0.02);
  rule.taken(6.0, true);
  EXPECT_TRUE(rule.last(0.3));
  EXPECT_FALSE(rule.last(0.35));
  EXPECT_FALSE(rule.last(7.0)) << "steps that grow promise nothing";
}

TEST(StoppingRule, ALargeStepIsLookedAt) {
  detail::StoppingRule rule(0.02);
  rule.taken(1000.0, true);
  EXPECT_TRUE(rule.last(1.0));
  EXPECT_FALSE(rule.last(1.01));
}

TEST(StoppingRule, ADampedStepIsNoHistory) {
  detail::StoppingRule rule(0.02);
  rule.taken(6.0, true);
  rule.taken(6.0, false);
  EXPECT_FALSE(rule.last(0.3));
}

TEST(StoppingRule, WhatIsNoNumberIsNotTheLast) {
  detail::StoppingRule rule(0.02);
  rule.taken(6.0, true);
  EXPECT_FALSE(rule.last(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(rule.last(std::numeric_limits<double>::infinity()));
}

/// y = x + b x^2 on three axes and their sums: mildly bent, over-determined.
struct Bent {
  ResidualVector y;
  double bend = 0.0;
  int evaluations = 0;

  static constexpr double kSigma = 0.1;
  static Eigen::Matrix<double, 6, 3> mix() {
    Eigen::Matrix<double, 6, 3> A;
    A << 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 0, 1, 1, 1, 0, 1;
    return A;
  }
  int rows() const { return 6; }
  void noise(ResidualMatrix& R) const { R = kSigma * kSigma * ResidualMatrix::Identity(6, 6); }
  bool linearize(const StateVector& x, Linearization& at) {
    ++evaluations;
    const Vector3d s = x.head<3>(), slope = Vector3d::Ones() + 2.0 * bend * s;
    at.residual = y - mix() * (s + bend * s.cwiseAbs2());
    at.jacobian = mix() * slope.asDiagonal();
    return true;
  }
};

struct Trial {
  Bent model;
  Gaussian prior;
};

Trial random_trial(Draws& draws) {
  const Vector3d truth = draws.normal3();
  Bent model;
  model.bend = draws.uniform(-0.06, 0.06);
  model.y = Bent::mix() * (truth + model.bend * truth.cwiseAbs2());
  for (int i = 0; i < 6; ++i) model.y(i) += Bent::kSigma * draws.normal();
  return {model, {StateVector::Zero(3), StateMatrix::Identity(3, 3)}};
}

/// Against the same update brought to its end: within the tolerance, its cost and residual those of where it stopped,
/// and with fewer evaluations. On 500 of 500 problems.
TEST(LastStep, TakenUnseenLeavesNoMoreThanTheTolerance) {
  Draws draws(61);
  int spared = 0;
  for (int i = 0; i < 500; ++i) {
    Trial trial = random_trial(draws), again = trial;
    Update update, exact;
    iterated_update(trial.model, trial.prior, trial.prior.mean, {}, update);
    iterated_update(again.model, again.prior, again.prior.mean, {.step_tolerance = 1e-9}, exact);
    ASSERT_EQ(update.status, UpdateStatus::kConverged);
    const Vector3d error = update.posterior.mean - exact.posterior.mean;
    const double sigmas = std::sqrt(error.dot(Matrix3d(exact.posterior.covariance).inverse() * error));
    EXPECT_LT(sigmas, UpdateOptions{}.step_tolerance);
    EXPECT_NEAR(update.chi_square, exact.chi_square, 0.02);
    Linearization at;
    trial.model.linearize(update.posterior.mean, at);
    EXPECT_LT((at.residual - update.at.residual).norm(), 0.2 * Bent::kSigma);
    EXPECT_NEAR(update.residual_chi_square, at.residual.squaredNorm() / (Bent::kSigma * Bent::kSigma), 0.2);
    spared += update.evaluations < exact.evaluations ? 1 : 0;
  }
  EXPECT_GT(spared, 450);
}

/// Sizes fixed at three or found at run time: the same update. A fourth state that nothing sees makes the latter.
TEST(LastStep, AFixedSizeChangesNothing) {
  struct WithOneMore : Bent {
    bool linearize(const StateVector& x, Linearization& at) {
      if (!Bent::linearize(x, at)) return false;
      const JacobianMatrix J = at.jacobian;
      at.jacobian.setZero(6, 4);
      at.jacobian.leftCols<3>() = J;
      return true;
    }
  };
  Draws draws(62);
  for (int i = 0; i < 50; ++i) {
    Trial trial = random_trial(draws);
    WithOneMore wider{trial.model};
    const Gaussian prior{StateVector::Zero(4), StateMatrix::Identity(4, 4)};
    Update fixed, dynamic;
    iterated_update(trial.model, trial.prior, trial.prior.mean, {}, fixed);
    iterated_update(wider, prior, prior.mean, {}, dynamic);
    EXPECT_EQ(fixed.evaluations, dynamic.evaluations);
    EXPECT_LT((fixed.posterior.mean - dynamic.posterior.mean.head<3>()).norm(), 1e-13);
    EXPECT_LT((fixed.posterior.covariance - dynamic.posterior.covariance.topLeftCorner<3, 3>()).norm(), 1e-14);
    EXPECT_NEAR(fixed.chi_square, dynamic.chi_square, 1e-10);
    EXPECT_NEAR(fixed.surprise, dynamic.surprise, 1e-8);
  }
}

TEST(Hopeless, IsGivenUpOnlyWhereNoStepPromisesLess) {
  Draws draws(63);
  Trial trial = random_trial(draws);
  trial.model.y.tail<3>().array() += 5.0;  // contradicts the first three rows: chi-square of some 10^4
  Update whole, spared, hopeful;
  iterated_update(trial.model, trial.prior, trial.prior.mean, {.step_tolerance = 1e-9}, whole);
  const auto until = [&](double cost, Update& out) {
    iterated_update(trial.model, trial.prior, trial.prior.mean, {.step_tolerance = 1e-9, .hopeless_cost = cost}, out);
  };
  until(0.5 * whole.chi_square, spared);
  until(1.5 * whole.chi_square, hopeful);
  EXPECT_EQ(spared.status, UpdateStatus::kNotConverged);
  EXPECT_LT(spared.evaluations, whole.evaluations);
  EXPECT_GT(spared.evaluations, 1) << "the first step is always tried";
  EXPECT_EQ(hopeful.status, UpdateStatus::kConverged);
  EXPECT_EQ(hopeful.evaluations, whole.evaluations);
}

}  // namespace
}  // namespace palpate
