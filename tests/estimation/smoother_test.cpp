// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/estimation/smoother.hpp>
#include <tests/estimation/motions.hpp>

namespace palpate {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::Draws;

/// A short recording with steps of different length, held frames, a jump, and a filter run over it.
struct Trajectory {
  std::vector<MotionStep> steps;
  std::vector<ForceLikelihood> frames;  ///< empty where held
  std::vector<Belief> beliefs;
  std::vector<Correction> corrections;
};

Trajectory run_over(const MotionModel& model, int frames, unsigned seed) {
  Draws draws(seed);
  test::DrawnMotion motion(model, draws);
  Trajectory run;
  const BeliefModel none(ParameterPrior{});
  Belief belief;
  none.initial(model, belief);
  for (int k = 0; k < frames; ++k) {
    MotionStep step;
    step.dt_s = k == 0 ? 0.0 : draws.uniform(0.01, 0.05);
    step.drive = Vector3d(0.1, 0.3, 1.0);
    step.rhythm = test::some_rhythm();
    step.jump = k == frames / 2;
    motion.advance(step);
    none.predict(model, step, belief);
    const bool held = k % 5 == 3;
    const ForceLikelihood y = held ? ForceLikelihood{} : test::measure(motion.seen_N(), test::tip_noise_N2(), draws);
    Correction correction;
    if (!held) {
      EXPECT_TRUE(none.update(model.seen(), line_of(y, 0), belief, correction));
    }
    run.steps.push_back(step);
    run.frames.push_back(y);
    run.beliefs.push_back(belief);
    run.corrections.push_back(correction);
  }
  return run;
}

/// Least squares for the whole trajectory at once: unknowns x_0 .. x_(N-1); the prior of x_0, the noise of every step
/// and every frame are rows of one big normal equation, whose inverse is the covariance.
std::vector<ForceGaussian> batch(const MotionModel& model, const Trajectory& run) {
  const int n = model.states(), count = static_cast<int>(run.steps.size());
  MatrixXd information = MatrixXd::Zero(n * count, n * count);
  VectorXd right = VectorXd::Zero(n * count);
  MotionState start;
  model.initial(start);
  model.predict(run.steps[0], start);
  const MatrixXd H = test::dense_map(model.seen()), C = test::dense_map(model.reported());
  information.topLeftCorner(n, n) += MatrixXd(start.covariance).inverse();
  for (int k = 0; k < count; ++k) {
    if (k > 0) {
      const MatrixXd A = test::dense_transition(model, run.steps[k]);
      const MatrixXd W = test::dense_noise(model, run.steps[k]).inverse();
      information.block(n * k, n * k, n, n) += W;
      information.block(n * (k - 1), n * (k - 1), n, n) += A.transpose() * W * A;
      information.block(n * k, n * (k - 1), n, n) -= W * A;
      information.block(n * (k - 1), n * k, n, n) -= A.transpose() * W;
    }
    information.block(n * k, n * k, n, n) += H.transpose() * run.frames[k].information_per_N2 * H;
    right.segment(n * k, n) += H.transpose() * run.frames[k].information_mean_per_N;
  }
  // Scaled to a unit diagonal: the raw numbers span 15 orders of magnitude.
  const VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const MatrixXd covariance = scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
  const VectorXd mean = covariance * right;
  std::vector<ForceGaussian> out;
  for (int k = 0; k < count; ++k)
    out.push_back({C * mean.segment(n * k, n), C * covariance.block(n * k, n * k, n, n) * C.transpose()});
  return out;
}

std::vector<ForceGaussian> smoothed(const MotionModel& model, const Trajectory& run, std::size_t frames) {
  RecordingSmoother smoother(model);
  for (std::size_t k = 0; k < frames; ++k) smoother.push(run.steps[k], run.beliefs[k]);
  std::vector<ForceGaussian> out;
  for (const SmoothedFrame& frame : smoother.smooth()) out.push_back(frame.force);
  return out;
}

class Smoothers : public ::testing::TestWithParam<int> {
 protected:
  const MotionModel model_{test::all_motions()[static_cast<std::size_t>(GetParam())]};
};

/// Tolerance: the dense inverse loses about the condition of its scaled matrix, 1e9, of 1e-16, on forces of 0.1 N and
/// variances that are compared as sigmas: 1e-4 of a sigma.
TEST_P(Smoothers, RecordingSmootherIsLeastSquaresOverTheTrajectory) {
  const Trajectory run = run_over(model_, 24, 71);
  const std::vector<ForceGaussian> expected = batch(model_, run), found = smoothed(model_, run, 24);
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Vector3d sigma = expected[k].covariance_N2.diagonal().cwiseSqrt();
    const Matrix3d difference = found[k].covariance_N2 - expected[k].covariance_N2;
    EXPECT_LT((found[k].mean_N - expected[k].mean_N).cwiseQuotient(sigma).norm(), 1e-4) << k;
    EXPECT_LT((sigma.asDiagonal().inverse() * difference * sigma.asDiagonal().inverse()).norm(), 1e-4) << k;
  }
}

TEST_P(Smoothers, FixedLagIsTheRecordingSmootherOfTheDataSoFar) {
  constexpr int kLag = 7;
  const Trajectory run = run_over(model_, 40, 72);
  FixedLagSmoother lagged(model_, kLag);
  for (std::size_t k = 0; k < run.steps.size(); ++k) {
    lagged.push(run.steps[k], run.corrections[k], run.beliefs[k]);
    const std::vector<ForceGaussian> expected = smoothed(model_, run, k + 1);
    ASSERT_EQ(lagged.available(), std::min<int>(static_cast<int>(k) + 1, kLag + 1));
    for (int age = 0; age < lagged.available(); ++age) {
      const ForceGaussian a = lagged.force(age, run.beliefs[k]);
      const ForceGaussian& b = expected[k - static_cast<std::size_t>(age)];
      const Vector3d sigma = b.covariance_N2.diagonal().cwiseSqrt();
      const Matrix3d difference = a.covariance_N2 - b.covariance_N2;
      EXPECT_LT((a.mean_N - b.mean_N).cwiseQuotient(sigma).norm(), 1e-5) << k << ' ' << age;
      EXPECT_LT((sigma.asDiagonal().inverse() * difference * sigma.asDiagonal().inverse()).norm(), 1e-5) << k;
    }
  }
}

std::string motion_name(const testing::TestParamInfo<int>& info) {
  constexpr std::array<const char*, 9> names{
      "Walk",   "WalkDisturbed",   "Velocity",        "VelocityDisturbed", "GaussMarkov", "GaussMarkovDisturbed",
      "Rhythm", "RhythmDisturbed", "VelocityUnfading"};
  return names[static_cast<std::size_t>(info.param)];
}
INSTANTIATE_TEST_SUITE_P(Laws, Smoothers, ::testing::Range(0, 9), motion_name);

/// A rate of 0.1 N/s without driving noise: the smoothed force of the first frame, though the filter knew nothing of
/// the rate there, lies on the line through all frames.
TEST(RecordingSmoother, FirstFramesLearnTheRateFromLaterOnes) {
  MotionOptions options;
  options.rate_memory_s = std::numeric_limits<double>::infinity();
  const MotionModel model(options);
  Draws draws(73);
  const BeliefModel none(ParameterPrior{});
  Belief belief;
  none.initial(model, belief);
  RecordingSmoother smoother(model);
  MotionStep step;
  step.drive.setConstant(1e-6);
  for (int k = 0; k < 200; ++k) {
    step.dt_s = k == 0 ? 0.0 : 0.025;
    none.predict(model, step, belief);
    const Vector3d truth = Vector3d::Constant(0.1 * 0.025 * k);
    Correction correction;
    const ForceLikelihood y = test::measure(truth, 1e-6 * Matrix3d::Identity(), draws);
    ASSERT_TRUE(none.update(model.seen(), line_of(y, 0), belief, correction));
    smoother.push(step, belief);
  }
  const ForceGaussian first = smoother.smooth().front().force;
  const double sigma_N = 1e-3 * 2.0 / std::sqrt(200.0);  // of a line's end through 200 points
  EXPECT_NEAR(std::sqrt(first.covariance_N2(0, 0)) / sigma_N, 1.0, 0.02);
  EXPECT_LT(first.mean_N.norm(), 4.0 * sigma_N * std::sqrt(3.0));
}

}  // namespace
}  // namespace palpate
