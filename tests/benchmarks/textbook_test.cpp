// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <benchmarks/textbook.hpp>
#include <palpate/estimation/kalman.hpp>
#include <palpate/sensing/shape_model.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <tests/sensing/virtual_setups.hpp>

/// The yardstick of the benchmarks is measured itself: it solves the same rod and finds the same maximum of the
/// posterior, so that a ratio of times compares two ways to one answer.
namespace palpate {
namespace {

const Vector3d kStiffness{0.2612e-3, 0.16664e-3, 0.1645e-3};

textbook::Shaft shaft(double k1_per_m) { return {0.07, 0.0653, kStiffness, {k1_per_m, 0.0, 0.0}}; }

Catheter catheter(double k1_per_m) {
  Catheter c = test::two_sensors();
  c.rod = uniform_rod(0.07, kStiffness, {k1_per_m, 0.0, 0.0});
  c.sensors[0].arc_length_m = 0.07;
  c.sensors[1].arc_length_m = 0.0653;
  return c;
}

struct Load {
  double k1_per_m;
  Vector3d force_tip_N;
};
const Load kLoads[] = {{0.0, {0.01, -0.02, -0.05}},
                       {19.41, {0.05, 0.03, -0.08}},
                       {24.57, {0.03, 0.03, -0.1}},
                       {39.99, {-0.06, 0.05, 0.1}},
                       {60.0, {0.0, 0.05, -0.1}}};

TEST(Textbook, SolvesTheSameRod) {
  for (const Load& load : kLoads) {
    const Catheter c = catheter(load.k1_per_m);
    const RodSolver solver(c.rod, std::array{0.07, 0.0653}, Accuracy::kReference);
    RodSolution<0> exact = solver.make_solution<0>();
    solver.solve({.force_tip_N = load.force_tip_N}, exact);
    const textbook::SensorPoses poses = textbook::solve_rod(shaft(load.k1_per_m), load.force_tip_N);
    const auto near = [](const Pose& a, const Pose& b) {
      EXPECT_LT((a.p - b.p).norm(), 1e-6);
      EXPECT_LT(log_so3(a.R.transpose() * b.R).norm(), 2e-5);
    };
    near(poses.tip, exact.points[0].T_base_local);
    near(poses.behind, exact.points[1].T_base_local);
  }
}

TEST(Textbook, IsOfFourthOrder) {
  const Vector3d F{0.03, 0.03, -0.1}, compliance = kStiffness.cwiseInverse(), u0{24.57, 0.0, 0.0};
  const auto tip = [&](int steps) {
    textbook::RodState y;
    textbook::integrate(0.07, steps, F, compliance, u0, y);
    return (Eigen::Matrix<double, 7, 1>() << y.w, y.a1, y.a2, y.a3, y.r1, y.r2, y.r3).finished();
  };
  const Eigen::Matrix<double, 7, 1> exact = tip(640);
  const double ratio = (tip(20) - exact).norm() / (tip(40) - exact).norm();
  EXPECT_GT(ratio, 12.0);
  EXPECT_LT(ratio, 22.0);
}

/// Small steps over a recording: both updates get the same prior in every frame and must end on the same posterior.
template <int Rows>
void expect_same_posteriors(MeasurementKind kind) {
  const Catheter c = catheter(24.57);
  const VirtualRecording recording = simulate_tracker(c, beating_wall_force, {.rate_hz = 40.0, .duration_s = 5.0});
  ShapeModel model(c, kind, {}, Accuracy::kReference);
  Gaussian prior{Vector3d::Zero(), 0.01 * Matrix3d::Identity()};
  Measurement measurement;
  Update update;
  for (const TrackerFrame& frame : recording.frames) {
    register_frame(c, frame, measurement);
    model.select(measurement, ~0U);
    ResidualMatrix noise;
    model.noise(noise);
    ASSERT_EQ(noise.rows(), Rows);
    const Eigen::Matrix<double, Rows, Rows> information =
        noise.llt().solve(ResidualMatrix::Identity(Rows, Rows).eval());
    const textbook::SensorPoses measured{measurement.poses[0].T_base_sensor, measurement.poses[1].T_base_sensor};
    iterated_update(model, prior, prior.mean, {.max_iterations = 60, .step_tolerance = 1e-7}, update);
    const textbook::Belief theirs =
        textbook::iekf_update<Rows>(shaft(24.57), {prior.mean, prior.covariance}, measured, information);
    const Vector3d sigma_N = update.posterior.covariance.diagonal().cwiseSqrt();
    EXPECT_LT((theirs.force_tip_N - update.posterior.mean).cwiseQuotient(sigma_N).norm(), 5e-3);
    EXPECT_LT((theirs.covariance_N2 - update.posterior.covariance).norm(), 1e-2 * update.posterior.covariance.norm());
    prior = {update.posterior.mean, update.posterior.covariance + 1e-4 * Matrix3d::Identity()};
  }
}

TEST(Textbook, FindsTheSamePosteriorFromPoses) { expect_same_posteriors<12>(MeasurementKind::kPoses); }
TEST(Textbook, FindsTheSamePosteriorFromTipAndCurvature) {
  expect_same_posteriors<9>(MeasurementKind::kTipAndCurvature);
}

}  // namespace
}  // namespace palpate
