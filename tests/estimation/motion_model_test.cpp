// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>
#include <palpate/math/errors.hpp>
#include <tests/estimation/motions.hpp>
#include <unsupported/Eigen/MatrixFunctions>

namespace palpate {
namespace {

using Eigen::MatrixXd;
using test::Draws;

MotionStep step_of(double dt_s) {
  MotionStep step;
  step.dt_s = dt_s;
  step.drive = Vector3d(0.3, 0.7, 1.1);
  step.rhythm = test::some_rhythm();
  return step;
}

/// x' = F x + w, <w w^T> = W, of one axis: written down from the docstring's differential equations.
struct Continuous {
  MatrixXd F, W;
};

Continuous continuous(const MotionOptions& o, const MotionStep& step, int axis) {
  MatrixXd F = MatrixXd::Zero(20, 20), W = F;
  int n = 1;
  const double q2 = step.drive(axis) * step.drive(axis);
  if (o.motion == ForceMotion::kRandomWalk) W(0, 0) = q2;
  if (o.motion == ForceMotion::kGaussMarkov) {
    F(0, 0) = -1.0 / o.force_memory_s;
    W(0, 0) = 2.0 * o.force_sigma_N * o.force_sigma_N / o.force_memory_s;
  }
  if (o.motion == ForceMotion::kConstantVelocity || o.motion == ForceMotion::kRhythm) {
    F(0, 1) = 1.0;
    F(1, 1) = -1.0 / o.rate_memory_s;
    W(1, 1) = q2;
    n = 2;
  }
  const auto oscillator = [&](double frequency_Hz, double sigma_N) {
    const double omega = 2.0 * std::numbers::pi * frequency_Hz;
    F(n, n) = F(n + 1, n + 1) = -1.0 / o.rhythm_memory_s;
    F(n, n + 1) = omega;
    F(n + 1, n) = -omega;
    W(n, n) = W(n + 1, n + 1) = 2.0 * sigma_N * sigma_N / o.rhythm_memory_s;
    n += 2;
  };
  if (o.motion == ForceMotion::kRhythm) {
    const Rhythm& r = step.rhythm;
    for (int h = 0; h < o.heart_harmonics; ++h) oscillator((h + 1) * r.heart_Hz, r.heart_sigma_N[h](axis));
    for (int h = 0; h < o.breathing_harmonics; ++h) oscillator((h + 1) * r.breathing_Hz, r.breathing_sigma_N[h](axis));
  }
  if (o.disturbance_rms_N.norm() > 0.0) {
    F(n, n) = -1.0 / o.disturbance_memory_s;
    W(n, n) = 2.0 * o.disturbance_rms_N(axis) * o.disturbance_rms_N(axis) / o.disturbance_memory_s;
    ++n;
  }
  return {F.topLeftCorner(n, n), W.topLeftCorner(n, n)};
}

/// Van Loan (1978): exp([-F W; 0 F^T] dt) = [. E12; . E22], A = E22^T, Q = A E12. The exponential is Eigen's, good to
/// about 1e-15 of its norm, which the growing half multiplies: steps stay at 0.1 s, tolerance 1e-11 of the size.
TEST(MotionModel, TransitionAndNoiseAreTheMatrixExponentials) {
  for (const MotionOptions& options : test::all_motions()) {
    const MotionModel model(options);
    for (const double dt_s : {1e-3, 0.02, 0.025, 0.1}) {
      const MotionStep step = step_of(dt_s);
      const MatrixXd A = test::dense_transition(model, step), Q = test::dense_noise(model, step);
      for (int axis = 0; axis < 3; ++axis) {
        const Continuous c = continuous(options, step, axis);
        const Eigen::Index n = c.F.rows();
        ASSERT_EQ(n, model.components());
        MatrixXd M = MatrixXd::Zero(2 * n, 2 * n);
        M << -c.F, c.W, MatrixXd::Zero(n, n), c.F.transpose();
        const MatrixXd E = (M * dt_s).exp();
        const MatrixXd A_axis = E.bottomRightCorner(n, n).transpose(), Q_axis = A_axis * E.topRightCorner(n, n);
        for (int r = 0; r < n; ++r)
          for (int k = 0; k < n; ++k) {
            EXPECT_NEAR(A(3 * r + axis, 3 * k + axis), A_axis(r, k), 1e-12);
            const double size = std::sqrt(Q_axis(r, r) * Q_axis(k, k));
            EXPECT_NEAR(Q(3 * r + axis, 3 * k + axis), Q_axis(r, k), 1e-8 * size + 1e-18) << r << ' ' << k;
          }
      }
    }
  }
}

/// The series of the fading rate's noise meets its closed form where one hands over to the other (u = 0.02), and the
/// limits u -> 0, u -> inf: q^2 dt^3 / 3 and the walk (q tau)^2 dt.
TEST(MotionModel, FadingRateHasNoSeam) {
  const FadingRate below(0.02 * (1.0 - 1e-9), 1.0), above(0.02 * (1.0 + 1e-9), 1.0);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(below.variance(i) / above.variance(i), 1.0, 1e-7);
  EXPECT_NEAR(below.travel_s / above.travel_s, 1.0, 1e-7);
  const FadingRate proper(0.1, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(proper.variance(0), 1e-3 / 3.0, 1e-16);
  EXPECT_NEAR(proper.variance(1), 5e-3, 1e-16);
  EXPECT_NEAR(proper.variance(2), 0.1, 1e-16);
  EXPECT_NEAR(FadingRate(1e4, 1.0).variance(0) / 1e4, 1.0, 1e-3);
}

TEST(MotionModel, PredictionIsTheDenseProductAndTwoStepsAreOne) {
  Draws draws(41);
  for (const MotionOptions& options : test::all_motions()) {
    const MotionModel model(options);
    MotionState state;
    model.initial(state);
    state.mean.setRandom();
    const MatrixXd L = 0.1 * MatrixXd::NullaryExpr(model.states(), model.states(), [&] { return draws.normal(); });
    state.covariance += L * L.transpose();
    const MotionStep step = step_of(0.05), half = step_of(0.025);
    MotionState whole = state, halves = state;
    model.predict(step, whole);
    model.predict(half, halves);
    model.predict(half, halves);
    const MatrixXd A = test::dense_transition(model, step);
    const MatrixXd expected = A * MatrixXd(state.covariance) * A.transpose() + test::dense_noise(model, step);
    EXPECT_LT((whole.mean - A * state.mean).norm(), 1e-13);
    EXPECT_LT((whole.covariance - expected).norm(), 1e-12);
    EXPECT_LT((whole.mean - halves.mean).norm(), 1e-12);
    EXPECT_LT((whole.covariance - halves.covariance).norm(), 1e-11);
    const ForceGaussian ahead = model.forecast(step, state);
    const MatrixXd C = test::dense_map(model.reported());
    EXPECT_LT((ahead.mean_N - C * A * state.mean).norm(), 1e-13);
    EXPECT_LT((ahead.covariance_N2 - C * expected * C.transpose()).norm(), 1e-12);
  }
}

/// 20 000 draws of the constant velocity's path in 50 small Euler steps: the forecast's sigma must be that of the draws
/// to 3 / sqrt(2 N) = 1.5 %, plus 2 % for Euler's steps.
TEST(MotionModel, ForecastIsTheSpreadOfDrawnPaths) {
  Draws draws(42);
  MotionOptions options;
  options.rate_memory_s = 0.3;
  const MotionModel model(options);
  MotionState known;
  model.initial(known);
  known.covariance.setZero();
  MotionStep step = step_of(0.2);
  const double sigma_N = std::sqrt(model.forecast(step, known).covariance_N2(1, 1));
  constexpr int kPaths = 20000, kSteps = 50;
  const double h = step.dt_s / kSteps;
  double sum2 = 0.0;
  for (int path = 0; path < kPaths; ++path) {
    double force = 0.0, rate = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      force += h * rate;
      rate += -h * rate / options.rate_memory_s + step.drive(1) * std::sqrt(h) * draws.normal();
    }
    sum2 += force * force;
  }
  EXPECT_NEAR(std::sqrt(sum2 / kPaths) / sigma_N, 1.0, 0.035);
}

TEST(MotionModel, TheDisturbanceIsSeenButNotReported) {
  MotionOptions options;
  options.disturbance_rms_N = Vector3d(0.01, 0.02, 0.03);
  const MotionModel model(options);
  MotionState state;
  model.initial(state);
  const Vector3d more =
      (force_of(model.seen(), state).covariance_N2 - force_of(model.reported(), state).covariance_N2).diagonal();
  EXPECT_LT((more - options.disturbance_rms_N.cwiseAbs2()).norm(), 1e-15);
}

TEST(MotionModel, AJumpOpensForceAndRate) {
  const MotionModel model(MotionOptions{});
  MotionStep step = step_of(0.025), jump = step;
  jump.jump = true;
  const MatrixXd more = test::dense_noise(model, jump) - test::dense_noise(model, step);
  Eigen::VectorXd expected(6);
  expected << 0.09, 0.09, 0.09, 1.0, 1.0, 1.0;
  EXPECT_LT((more - MatrixXd(expected.asDiagonal())).norm(), 1e-15);
}

TEST(MotionModel, OptionsOutOfRangeAreRefusedByName) {
  const auto message = [](const MotionOptions& options) -> std::string {
    try {
      const MotionModel model(options);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  MotionOptions options;
  options.rate_memory_s = 0.0;
  EXPECT_NE(message(options).find("rate_memory_s"), std::string::npos);
  options = {};
  options.disturbance_rms_N.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message(options).find("disturbance_rms_N"), std::string::npos);
  options = {};
  options.heart_harmonics = 4;
  EXPECT_NE(message(options).find("heart_harmonics"), std::string::npos);
}

}  // namespace
}  // namespace palpate
