// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <tests/estimation/motions.hpp>

namespace palpate {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::Draws;

MotionState random_state(int states, Draws& draws) {
  MotionState out;
  out.mean = VectorXd::NullaryExpr(states, [&] { return draws.normal(); });
  const MatrixXd L = MatrixXd::NullaryExpr(states, states, [&] { return draws.normal(); });
  out.covariance = L * L.transpose() + 0.1 * MatrixXd::Identity(states, states);
  return out;
}

/// The textbook's update of the whole state by a measurement of F = H x, y = F + e, e ~ N(0, R), must equal the
/// three-dimensional update of N(H x, H P H^T) handed on by condition(). Up to 39 states of size 1, conditions to 1e3:
/// rounding stays below 1e-10.
TEST(Condition, EqualsTheTextbookOnTheWholeState) {
  Draws draws(51);
  for (const MotionOptions& options : test::all_motions()) {
    const MotionModel model(options);
    for (int trial = 0; trial < 20; ++trial) {
      const MotionState before = random_state(model.states(), draws);
      const ForceLikelihood y = test::measure(draws.normal3(), test::tip_noise_N2() * 1e4, draws);
      const MatrixXd H = test::dense_map(model.seen()), P = before.covariance, R = y.information_per_N2.inverse();
      const MatrixXd S = H * P * H.transpose() + R, K = P * H.transpose() * S.inverse();
      const VectorXd mean = before.mean + K * (R * y.information_mean_per_N - H * before.mean);

      MotionState state = before;
      ForceCorrection correction;
      ASSERT_TRUE(condition(model.seen(), posterior_of(force_of(model.seen(), before), y), state, correction));
      EXPECT_LT((state.mean - mean).norm(), 1e-10);
      EXPECT_LT((state.covariance - (P - K * S * K.transpose())).norm(), 1e-10);
      EXPECT_EQ(MatrixXd(state.covariance), MatrixXd(state.covariance.transpose()));
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatrixXd>(state.covariance).eigenvalues()(0), 0.0);
    }
  }
}

/// From 0.3 N to 0.1 uN and again 10 000 times: no drift away from symmetric and positive definite.
TEST(Condition, StaysDefiniteOverManySharpUpdates) {
  Draws draws(52);
  const MotionModel model(MotionOptions{});
  MotionState state;
  model.initial(state);
  MotionStep step;
  step.dt_s = 0.025;
  step.drive = Vector3d(5e-4, 1.0, 50.0);
  ForceCorrection correction;
  for (int k = 0; k < 10000; ++k) {
    step.jump = k % 100 == 99;
    model.predict(step, state);
    const ForceLikelihood y = test::measure(Vector3d::Zero(), 1e-14 * Matrix3d::Identity(), draws);
    ASSERT_TRUE(condition(model.seen(), posterior_of(force_of(model.seen(), state), y), state, correction));
    ASSERT_GT(state.covariance.diagonal().minCoeff(), 0.0);
  }
  EXPECT_LT(force_of(model.seen(), state).mean_N.norm(), 1e-6);
}

TEST(Condition, RefusesWhatIsNotFiniteAndKeepsTheState) {
  Draws draws(53);
  const MotionModel model(MotionOptions{});
  const MotionState before = random_state(model.states(), draws);
  ForceGaussian bad = force_of(model.seen(), before);
  bad.mean_N.x() = std::numeric_limits<double>::quiet_NaN();
  ForceGaussian worse = force_of(model.seen(), before);
  worse.covariance_N2(2, 2) = std::numeric_limits<double>::quiet_NaN();
  ForceGaussian negative = force_of(model.seen(), before);
  negative.covariance_N2 = -Matrix3d::Identity();
  for (const ForceGaussian& posterior : {bad, worse, negative}) {
    MotionState state = before;
    ForceCorrection correction;
    EXPECT_FALSE(condition(model.seen(), posterior, state, correction));
    EXPECT_EQ(state.mean, before.mean);
    EXPECT_EQ(state.covariance, before.covariance);
  }
}

/// Information that was put in comes out, though the prior is 1000 times wider or 30 times narrower than the sensors.
TEST(ForceLikelihood, IsWhatTurnedPriorIntoPosterior) {
  Draws draws(54);
  const Matrix3d R = test::tip_noise_N2();
  for (const double prior_N : {1e-4, 1e-2, 0.3}) {
    const ForceGaussian prior{0.01 * draws.normal3(), prior_N * prior_N * Matrix3d::Identity()};
    const ForceLikelihood y = test::measure(draws.normal3() * 0.02, R, draws);
    const ForceLikelihood found = likelihood_between(prior, posterior_of(prior, y));
    const double size = y.information_per_N2.norm();
    EXPECT_LT((found.information_per_N2 - y.information_per_N2).norm(), 1e-7 * size);
    EXPECT_LT((found.information_mean_per_N - y.information_mean_per_N).norm(), 1e-7 * size);
  }
}

TEST(ForceLikelihood, OfAFrameThatSaysNothingIsEmpty) {
  const ForceGaussian prior{Vector3d(0.1, 0.2, 0.3), 0.04 * test::tip_noise_N2()};
  EXPECT_LT(likelihood_between(prior, prior).information_per_N2.norm() * prior.covariance_N2.norm(), 1e-9);
  ForceGaussian lost = prior;
  lost.covariance_N2(0, 0) = -1.0;
  EXPECT_EQ(likelihood_between(prior, lost).information_per_N2, Matrix3d(Matrix3d::Zero()));
  EXPECT_EQ(likelihood_between(lost, prior).information_per_N2, Matrix3d(Matrix3d::Zero()));
}

TEST(ForceLikelihood, PosteriorIsTheSumOfInformation) {
  Draws draws(55);
  const ForceGaussian prior{draws.normal3(), test::tip_noise_N2() * 30.0};
  ForceLikelihood y = test::measure(draws.normal3(), test::tip_noise_N2(), draws);
  const ForceGaussian posterior = posterior_of(prior, y);
  const Matrix3d information = prior.covariance_N2.inverse() + y.information_per_N2;
  EXPECT_LT((posterior.covariance_N2 * information - Matrix3d::Identity()).norm(), 1e-9);
  const Vector3d mean =
      information.ldlt().solve(prior.covariance_N2.inverse() * prior.mean_N + y.information_mean_per_N);
  EXPECT_LT((posterior.mean_N - mean).norm(), 1e-9);
}

/// By hand, uncorrelated: variance 4 > 1 on z becomes 1, its mean 8 shrinks by 1 / 4; x and y are left alone.
/// Correlated: what x knows of z through the correlation is pulled along, and no variance exceeds the limit.
TEST(WithinBelief, ShrinksOnlyWhatIsUnbelievable) {
  const ForceGaussian wide{Vector3d(0.5, -3.0, 8.0), Vector3d(0.25, 1.0, 4.0).asDiagonal()};
  const ForceGaussian found = within_belief(wide, 1.0);
  EXPECT_LT((found.mean_N - Vector3d(0.5, -3.0, 2.0)).norm(), 1e-14);
  EXPECT_LT((found.covariance_N2 - Matrix3d(Vector3d(0.25, 1.0, 1.0).asDiagonal())).norm(), 1e-14);
  const ForceGaussian turned{Vector3d(1.0, 2.0, 3.0), 1e5 * test::tip_noise_N2()};
  const ForceGaussian believed = within_belief(turned, 0.5);
  EXPECT_LT(believed.covariance_N2.diagonal().maxCoeff(), 0.25 + 1e-12);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix3d>(believed.covariance_N2).eigenvalues()(0), 0.0);
}

}  // namespace
}  // namespace palpate
