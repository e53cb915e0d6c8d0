// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <palpate/reproduction/independent_map.hpp>
#include <palpate/reproduction/methods.hpp>
#include <palpate/reproduction/paper_figures.hpp>

namespace palpate::reproduction {
namespace {

const Vector3d kForce_N(0.05, 0.03, -0.1);

/// d r / d x by central differences, each step a share of the state's size.
JacobianMatrix differences(PaperModel& model, const StateVector& x, const StateVector& size) {
  JacobianMatrix J(model.rows(), x.size());
  Linearization above, below;
  for (int i = 0; i < x.size(); ++i) {
    StateVector step = StateVector::Zero(x.size());
    step(i) = 1e-5 * size(i);
    EXPECT_TRUE(model.linearize(x + step, above) && model.linearize(x - step, below));
    J.col(i) = (below.residual - above.residual) / (2.0 * step(i));
  }
  return J;
}

TEST(PaperModel, JacobianOfForceAndStiffnessIsTheDerivative) {
  const Catheter catheter = paper_catheter();
  const Measurement data = ExactShape(catheter).measure(kForce_N);
  StateVector x(5), size(5);
  x << 0.04, 0.05, -0.08, 1.1 * kEI1_Nm2, 0.8 * kEI2_Nm2;
  size << Vector3d::Constant(0.1), kEI1_Nm2, kEI2_Nm2;
  PaperModel model(catheter, true, paper_noise());
  model.select(data);
  Linearization at;
  ASSERT_TRUE(model.linearize(x, at));
  ASSERT_EQ(at.jacobian.rows(), 9);
  const JacobianMatrix expected = differences(model, x, size);
  for (int i = 0; i < 5; ++i)
    EXPECT_LT((at.jacobian.col(i) - expected.col(i)).norm(), 1e-6 * expected.col(i).norm()) << "state " << i;
}

TEST(PaperModel, ResidualVanishesAtTheTruthOfAnotherStiffness) {
  const Catheter catheter = paper_catheter();
  const Vector3d log_stiffness(std::log(1.2), std::log(0.9),
                               std::log((1.2 * kEI1_Nm2 + 0.9 * kEI2_Nm2) / (kEI1_Nm2 + kEI2_Nm2)));
  const Measurement data = ExactShape(catheter).measure(kForce_N, log_stiffness);
  StateVector x(5);
  x << kForce_N, 1.2 * kEI1_Nm2, 0.9 * kEI2_Nm2;
  PaperModel model(catheter, true, paper_noise());
  model.select(data);
  Linearization at;
  ASSERT_TRUE(model.linearize(x, at));
  EXPECT_LT(at.residual.head<6>().cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT(at.residual.tail<3>().cwiseAbs().maxCoeff(), 1e-6);
  x(3) = -1e-4;
  EXPECT_FALSE(model.linearize(x, at)) << "a negative stiffness bends no shaft";
}

TEST(PaperFilter, IekfIsTheMaximumOfThePosterior) {
  const Catheter catheter = paper_catheter();
  for (const Course& course : {figure3_course(catheter), sine_course(catheter, 45)})
    for (const double factor : {0.02, 1.0, 50.0}) {
      const Vector3d start_N = course.force_tip_N.front();
      const PaperOptions options{.R = factor * paper_noise()};
      const auto iekf = run_filter(catheter, options, course, {.force_tip_N = start_N});
      const auto map_N = independent_map_errors(catheter, course, options.Q_N2, {options.R}, start_N);
      EXPECT_LT(rmse_distance(iekf.error_N, map_N), 1e-3) << factor << " R";
      EXPECT_EQ(iekf.unconverged, 0);
    }
}

TEST(PaperFilter, IaekfIsTheMaximumUnderTheNoiseItHasAdapted) {
  const Catheter catheter = paper_catheter();
  const Course course = figure3_course(catheter);
  const Vector3d start_N = course.force_tip_N.front();
  const auto iaekf = run_filter(catheter, {.method = PaperMethod::kIaekf}, course, {.force_tip_N = start_N});
  const auto map_N = independent_map_errors(catheter, course, 9e-2, iaekf.R, start_N);
  EXPECT_LT(rmse_distance(iaekf.error_N, map_N), 1e-3);
  EXPECT_LT(iaekf.R.back()(0), 1e-2 * iaekf.R.front()(0)) << "exact data: R falls";
}

TEST(PaperFilter, ExactDataLagAsMuchAsQAndRForce) {
  const Catheter catheter = paper_catheter();
  const Course course = sine_course(catheter);
  const auto iekf = run_filter(catheter, {}, course);
  EXPECT_LT(rmse_distance(iekf.error_N, forced_lag(catheter, course, 9e-2, {paper_noise()})), 1e-2);
}

/// Table 4 of the paper names its force, its rate and R: only k1,0 is ours.
TEST(PaperFilter, IaekfIsAtOrBelowTheWholeOfTable4) {
  const Catheter catheter = paper_catheter();
  const Course course = sine_course(catheter);
  for (std::size_t i = 0; i < paper::kTable4Factors.size(); ++i)
    for (const int tuning : {0, kTuningSamples}) {
      const PaperOptions options{.method = PaperMethod::kIaekf, .R = paper::kTable4Factors[i] * paper_noise()};
      const auto run = run_filter(catheter, options, course, {.tuning_samples = tuning});
      EXPECT_LE(statistics(run.error_N).rmse.x(), paper::kTable4[2][i]) << paper::kTable4Factors[i] << " R, " << tuning;
    }
}

TEST(PaperFilter, TunedIaekfIsAtOrBelowTable3) {
  const Catheter catheter = paper_catheter();
  const Course course = figure3_course(catheter);
  const auto run = run_filter(catheter, {.method = PaperMethod::kIaekf}, course,
                              {.force_tip_N = course.force_tip_N.front(), .tuning_samples = kTuningSamples});
  const Statistics s = statistics(run.error_N);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LE(s.max_abs(axis), paper::kTable3[2].max_abs[static_cast<std::size_t>(axis)]);
    EXPECT_LE(std::abs(s.mean(axis)), paper::kTable3[2].mean[static_cast<std::size_t>(axis)]);
    EXPECT_LE(s.std(axis), paper::kTable3[2].std[static_cast<std::size_t>(axis)]);
  }
}

/// Eq. (17) written out, one linear step.
TEST(PaperFilter, EkfIsEquation17) {
  const Catheter catheter = paper_catheter();
  const Measurement data = ExactShape(catheter).measure(kForce_N);
  PaperFilter filter(catheter, {.method = PaperMethod::kEkf});
  filter.start(Vector3d(0.04, 0.02, -0.09));
  PaperModel model(catheter, false, paper_noise());
  model.select(data);
  Linearization at;
  ASSERT_TRUE(model.linearize(Vector3d(0.04, 0.02, -0.09), at));
  const Eigen::MatrixXd J = at.jacobian, P = 0.18 * Eigen::MatrixXd::Identity(3, 3), R = paper_noise().asDiagonal();
  const Eigen::MatrixXd S = J * P * J.transpose() + R, K = P * J.transpose() * S.inverse();
  const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(3, 3) - K * J;
  const PaperStep& step = filter.update(data);
  EXPECT_LT((filter.force_tip_N() - Vector3d(0.04, 0.02, -0.09) - K * at.residual).norm(), 1e-9);
  EXPECT_LT((step.update.posterior.covariance - (A * P * A.transpose() + K * R * K.transpose())).norm(),
            1e-9 * P.norm());
  const Eigen::VectorXd r = step.update.at.residual;
  const Eigen::MatrixXd J_after = step.update.at.jacobian, S_after = J_after * P * J_after.transpose() + R;
  EXPECT_NEAR(step.rho.paper, r.dot(S_after * r), 1e-9 * step.rho.paper);
  EXPECT_NEAR(step.rho.normalised, r.dot(S_after.inverse() * r), 1e-6 * step.rho.normalised);
}

TEST(PaperFilter, KeepsItsPredictionWithoutATip) {
  PaperFilter filter(paper_catheter(), {});
  filter.start(kForce_N);
  const PaperStep& step = filter.update({});
  EXPECT_EQ(step.update.status, UpdateStatus::kFailed);
  EXPECT_EQ(filter.force_tip_N(), kForce_N);
}

}  // namespace
}  // namespace palpate::reproduction
