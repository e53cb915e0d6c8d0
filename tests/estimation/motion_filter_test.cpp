// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <palpate/estimation/smoother.hpp>
#include <tests/estimation/motions.hpp>
#include <tests/observer/allocation_counter.hpp>

namespace palpate {
namespace {

using Eigen::MatrixXd;
using test::Draws;

using Force = std::function<Vector3d(double)>;

MotionFilter default_filter(ForceMotion motion = ForceMotion::kConstantVelocity) {
  MotionOptions options;
  options.motion = motion;
  return {options, ProcessNoiseOptions::of(motion)};
}

/// What a run came to, from `from_s` on.
struct Score {
  Vector3d rmse_ratio = Vector3d::Zero();  ///< RMSE / the sigma of a frame
  double mean_nees = 0.0;
  double mean_nis = 0.0;                       ///< of the seen force: three degrees of freedom
  Vector3d within_4_sigma = Vector3d::Zero();  ///< share
};

/// Follows `force` from 0 to `to_s`; frames are announced as jumps where `jumps` says so.
Score follow(
    MotionFilter& filter, const Force& force, double rate_Hz, double from_s, double to_s, unsigned seed,
    const std::function<bool(int)>& jumps = [](int) { return false; }) {
  Draws draws(seed);
  const Matrix3d R = test::tip_noise_N2();
  Score score;
  int count = 0;
  for (int k = 0; k < to_s * rate_Hz; ++k) {
    const Vector3d truth = force(k / rate_Hz);
    filter.predict(k == 0 ? 0.0 : 1.0 / rate_Hz);
    const ForceGaussian prior = filter.prior();
    const ForceLikelihood y = test::measure(truth, R, draws);
    EXPECT_TRUE(filter.absorb(y, jumps(k)));
    if (k < from_s * rate_Hz) continue;
    const Vector3d innovation = R * y.information_mean_per_N - prior.mean_N;
    score.mean_nis += innovation.dot((prior.covariance_N2 + R).llt().solve(innovation));
    const ForceGaussian found = filter.reported();
    const Vector3d error = found.mean_N - truth;
    score.rmse_ratio += error.cwiseAbs2().cwiseQuotient(R.diagonal());
    score.mean_nees += error.dot(found.covariance_N2.llt().solve(error));
    const Vector3d sigma = found.covariance_N2.diagonal().cwiseSqrt();
    score.within_4_sigma += (error.array().abs() < 4.0 * sigma.array()).cast<double>().matrix();
    ++count;
  }
  score.rmse_ratio = (score.rmse_ratio / count).cwiseSqrt();
  score.mean_nees /= count;
  score.mean_nis /= count;
  score.within_4_sigma /= count;
  return score;
}

Vector3d swing(double t_s) {
  const double phase = 2.0 * std::numbers::pi * t_s;
  return {0.02 * std::sin(0.25 * phase), 0.04 + 0.03 * std::cos(1.2 * phase), -0.1 + 0.08 * std::sin(1.2 * phase)};
}

/// With the drive given, the filter must be the textbook's Kalman filter of the whole state, frame by frame; every
/// fifth frame is held.
TEST(MotionFilter, IsTheTextbooksKalmanFilterWhereTheDriveIsGiven) {
  for (const MotionOptions& options : test::all_motions()) {
    if (options.motion == ForceMotion::kRhythm) continue;  // finds its frequencies by itself
    Draws draws(101);
    const Vector3d drive(0.1, 0.3, 1.0);
    MotionFilter filter(options, drive);
    const MotionModel& model = filter.model();
    const MatrixXd H = test::dense_map(model.seen()), C = test::dense_map(model.reported());
    MotionState start;
    model.initial(start);
    Eigen::VectorXd x = start.mean;
    MatrixXd P = start.covariance;
    for (int k = 0; k < 100; ++k) {
      MotionStep step;
      step.dt_s = k == 0 ? 0.0 : draws.uniform(0.01, 0.05);
      step.drive = drive;
      const MatrixXd A = test::dense_transition(model, step);
      x = A * x;
      P = A * P * A.transpose() + test::dense_noise(model, step);
      filter.predict(step.dt_s);
      EXPECT_LT((filter.prior().mean_N - H * x).norm(), 1e-9);
      if (k % 5 == 4) {
        filter.hold();
        continue;
      }
      const ForceLikelihood y = test::measure(swing(0.025 * k), test::tip_noise_N2(), draws);
      const MatrixXd R = y.information_per_N2.inverse(), S = H * P * H.transpose() + R;
      const MatrixXd K = P * H.transpose() * S.inverse();
      x += K * (R * y.information_mean_per_N - H * x);
      P -= K * S * K.transpose();
      ASSERT_TRUE(filter.absorb(y, false));
      EXPECT_LT((filter.reported().mean_N - C * x).norm(), 1e-9);
      EXPECT_LT((filter.reported().covariance_N2 - C * P * C.transpose()).norm(), 1e-11);
    }
  }
}

TEST(MotionFilter, DoesNotTouchTheHeap) {
  for (const MotionOptions& options : test::all_motions()) {
    Draws draws(102);
    MotionFilter filter(options, ProcessNoiseOptions::of(options.motion));
    FixedLagSmoother smoother(filter.model(), 5);
    std::vector<ForceLikelihood> frames;
    for (int k = 0; k < 100; ++k) frames.push_back(test::measure(swing(0.025 * k), test::tip_noise_N2(), draws));
    const test::CountAllocations count;
    for (int k = 0; k < 100; ++k) {
      filter.predict(0.025);
      if (k % 10 == 5)
        filter.hold();
      else
        filter.absorb(frames[static_cast<std::size_t>(k)], k % 10 == 7);
      smoother.push(filter.step(), filter.correction(), filter.belief());
      filter.forecast(0.1);
    }
    EXPECT_EQ(count.so_far(), 0U);
  }
}

/// Drawn from the law with a drive that the filter has to find: better than a frame alone, and an honest covariance.
/// NEES of 4000 frames that are correlated over about ten: 3 +- 0.4 at three sigmas.
TEST(MotionFilter, IsConsistentOnForcesDrawnFromItsLaw) {
  for (const auto& [motion, q] :
       {std::pair(ForceMotion::kRandomWalk, 0.01), std::pair(ForceMotion::kRandomWalk, 0.1),
        std::pair(ForceMotion::kConstantVelocity, 0.1), std::pair(ForceMotion::kConstantVelocity, 1.0)}) {
    Draws draws(103);
    MotionFilter filter = default_filter(motion);
    test::DrawnMotion truth(filter.model(), draws);
    MotionStep step;
    step.dt_s = 0.025;
    step.drive.setConstant(q);
    const auto force = [&](double) {
      truth.advance(step);
      return truth.reported_N();
    };
    const Score score = follow(filter, force, 40.0, 5.0, 105.0, 104);
    EXPECT_LT(score.rmse_ratio.maxCoeff(), 1.0) << q;
    EXPECT_GT(score.mean_nees, 2.4) << q;
    EXPECT_LT(score.mean_nees, 3.6) << q;
    EXPECT_GT(score.mean_nis, 2.4) << q;
    EXPECT_LT(score.mean_nis, 3.3) << q;
    EXPECT_GT(score.within_4_sigma.minCoeff(), 0.995) << q;
  }
}

/// The same default at 10 to 1000 Hz on a beating force: never worse than a frame alone, and the better the faster.
TEST(MotionFilter, OneDefaultServesTenToAThousandHertz) {
  double before = 1.05;
  for (const double rate_Hz : {10.0, 40.0, 200.0, 1000.0}) {
    MotionFilter filter = default_filter();
    const Score score = follow(filter, swing, rate_Hz, 2.0, 20.0, 105);
    EXPECT_LT(score.rmse_ratio.maxCoeff(), before) << rate_Hz;
    EXPECT_GT(score.mean_nees, 2.2) << rate_Hz;
    EXPECT_LT(score.mean_nees, 3.6) << rate_Hz;
    before = score.rmse_ratio.maxCoeff();
  }
  EXPECT_LT(before, 0.5);
}

/// At rest for a minute: the sigma of the force falls to below 0.6 of a frame's, but not below a tenth of it (6000
/// frames would average to a fiftieth; nothing rests so well). Then it moves off at 0.5 N/s without a word: within
/// three frames the truth lies within 4 sigma again and stays there.
TEST(MotionFilter, RestsAndMovesOff) {
  MotionFilter filter = default_filter();
  const auto force = [](double t) -> Vector3d {
    return Vector3d(0.0, 0.05, -0.1) + std::max(0.0, t - 60.0) * Vector3d(0.1, 0.5, -0.5);
  };
  const Score rest = follow(filter, force, 40.0, 20.0, 60.0, 106);
  const Vector3d sigma = filter.reported().covariance_N2.diagonal().cwiseSqrt();
  const Vector3d frame = test::tip_noise_N2().diagonal().cwiseSqrt();
  EXPECT_LT(sigma.cwiseQuotient(frame).maxCoeff(), 0.6);
  EXPECT_GT(sigma.cwiseQuotient(frame).minCoeff(), 0.1);
  EXPECT_GT(rest.within_4_sigma.minCoeff(), 0.995);

  Draws draws(107);
  for (int k = 1; k <= 40; ++k) {
    const Vector3d truth = force(60.0 + 0.025 * k);
    filter.predict(0.025);
    ASSERT_TRUE(filter.absorb(test::measure(truth, test::tip_noise_N2(), draws), false));
    const ForceGaussian found = filter.reported();
    if (k >= 3) {
      for (int i = 0; i < 3; ++i)
        EXPECT_LT(std::abs(found.mean_N(i) - truth(i)), 4.0 * std::sqrt(found.covariance_N2(i, i))) << k << ' ' << i;
    }
  }
}

/// Jumps anywhere in a ball of 0.3 N every half second, announced: between them the force is averaged (better than a
/// frame alone), the covariance is honest.
TEST(MotionFilter, AnnouncedJumpsAreForgotten) {
  MotionFilter filter = default_filter();
  Draws draws(108);
  Vector3d held_N = Vector3d::Zero();
  int frame = 0;
  const auto force = [&](double) {
    if (frame++ % 20 == 0) held_N = draws.in_ball(0.3);
    return held_N;
  };
  const Score score = follow(filter, force, 40.0, 1.0, 60.0, 109, [](int k) { return k > 0 && k % 20 == 0; });
  EXPECT_LT(score.rmse_ratio.maxCoeff(), 0.95);
  EXPECT_GT(score.within_4_sigma.minCoeff(), 0.995);
  EXPECT_GT(score.mean_nees, 2.2);
  EXPECT_LT(score.mean_nees, 3.6);
}

/// An axis that no sensor sees, for ten minutes: its sigma stays at what is believed before any frame (0.3 N, or
/// sqrt(2) times that), its mean near zero; the others do not notice. A gap of a minute is the same for all axes.
TEST(MotionFilter, WhatIsNotSeenStaysWithinBelief) {
  MotionFilter filter = default_filter();
  Draws draws(110);
  for (int k = 0; k < 24000; ++k) {
    filter.predict(0.025);
    ForceLikelihood y = test::measure(swing(0.025 * k), 1e-6 * Matrix3d::Identity(), draws);
    y.information_per_N2.row(2).setZero();
    y.information_per_N2.col(2).setZero();
    y.information_mean_per_N.z() = 0.0;
    ASSERT_TRUE(filter.absorb(y, false));
  }
  const ForceGaussian found = filter.reported();
  EXPECT_LT(std::abs(found.mean_N.z()), 0.01);
  EXPECT_NEAR(std::sqrt(found.covariance_N2(2, 2)), 0.36, 0.07);
  EXPECT_LT(found.covariance_N2.diagonal().head<2>().maxCoeff(), 1e-6);

  filter.predict(60.0);
  filter.hold();
  for (int i = 0; i < 3; ++i) EXPECT_LT(std::sqrt(filter.reported().covariance_N2(i, i)), 0.43);
  EXPECT_LT(filter.reported().mean_N.norm(), 0.05);
  EXPECT_LT(std::sqrt(filter.forecast(10.0).covariance_N2(0, 0)), 0.43);
}

/// Blood that drums at the tip with 10 mN for 0.1 s at a time is seen by the sensors. Declared, it is kept out of the
/// reported force, which is nearer to the tissue's (by a sixth at least; how much depends on how sure the drive is) and
/// honest; not declared, it is followed.
TEST(MotionFilter, ADeclaredDisturbanceIsKeptOutOfTheForce) {
  MotionOptions options;
  options.disturbance_rms_N.setConstant(0.01);
  MotionFilter knows(options, ProcessNoiseOptions{}), ignorant = default_filter();
  Draws draws(111);
  MotionModel blood(options);
  test::DrawnMotion disturbance(blood, draws);
  MotionStep step;
  step.dt_s = 0.025;
  double with = 0.0, without = 0.0, nees = 0.0;
  constexpr int kFrames = 4000;
  for (int k = 0; k < kFrames; ++k) {
    disturbance.advance(step);
    const double t = 0.025 * k;
    const Vector3d tissue_N = Vector3d(0.02, 0.05, -0.1) * (1.0 + 0.3 * std::sin(0.6 * t));
    const ForceLikelihood y = test::measure(tissue_N + disturbance.seen_N(), 1e-6 * Matrix3d::Identity(), draws);
    for (MotionFilter* filter : {&knows, &ignorant}) {
      filter->predict(step.dt_s);
      ASSERT_TRUE(filter->absorb(y, false));
    }
    const Vector3d error = knows.reported().mean_N - tissue_N;
    if (k < 200) continue;
    with += error.squaredNorm();
    without += (ignorant.reported().mean_N - tissue_N).squaredNorm();
    nees += error.dot(knows.reported().covariance_N2.llt().solve(error)) / (kFrames - 200);
  }
  EXPECT_LT(std::sqrt(with), 0.85 * std::sqrt(without));
  EXPECT_GT(nees, 1.8);
  EXPECT_LT(nees, 3.9);
}

/// A beat that has been heard can be foretold: 0.2 s ahead, a quarter of its period, with less than half the error of
/// the extrapolated velocity.
TEST(MotionFilter, RhythmForeseesTheBeat) {
  MotionFilter rhythm = default_filter(ForceMotion::kRhythm), velocity = default_filter();
  Draws draws(112);
  double error_rhythm = 0.0, error_velocity = 0.0;
  for (int k = 0; k < 2400; ++k) {
    const ForceLikelihood y = test::measure(swing(0.025 * k), test::tip_noise_N2(), draws);
    for (MotionFilter* filter : {&rhythm, &velocity}) {
      filter->predict(0.025);
      ASSERT_TRUE(filter->absorb(y, false));
    }
    if (k < 1200) continue;
    const Vector3d truth = swing(0.025 * k + 0.2);
    error_rhythm += (rhythm.forecast(0.2).mean_N - truth).squaredNorm();
    error_velocity += (velocity.forecast(0.2).mean_N - truth).squaredNorm();
  }
  EXPECT_TRUE(rhythm.rhythm().heart_locked());
  EXPECT_LT(std::sqrt(error_rhythm), 0.5 * std::sqrt(error_velocity));
}

TEST(MotionFilter, AFrameThatIsNotFiniteIsHeld) {
  MotionFilter filter = default_filter(), held = default_filter();
  Draws draws(113);
  for (MotionFilter* f : {&filter, &held}) {
    f->predict(0.0);
    f->absorb(test::measure(Vector3d(0.0, 0.1, 0.1), test::tip_noise_N2(), draws), false);
    f->predict(0.025);
  }
  ForceLikelihood bad;
  bad.information_mean_per_N.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(filter.absorb(bad, false));
  EXPECT_TRUE(filter.reported().mean_N.allFinite());
  EXPECT_GT(filter.reported().covariance_N2.diagonal().minCoeff(), 0.0);
  EXPECT_EQ(filter.correction().rows, 0);
}

}  // namespace
}  // namespace palpate
