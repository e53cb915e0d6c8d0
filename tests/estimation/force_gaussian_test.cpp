// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <tests/estimation/motions.hpp>

namespace palpate {
namespace {

using test::Draws;

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
