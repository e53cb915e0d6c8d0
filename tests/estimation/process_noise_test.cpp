// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/math/errors.hpp>
#include <tests/estimation/motions.hpp>

namespace palpate {
namespace {

using test::Draws;

const ForceGaussian kNothing{Vector3d::Zero(), Matrix3d::Zero()};

MotionOptions law(ForceMotion motion) {
  MotionOptions options;
  options.motion = motion;
  return options;
}

/// Geometric mean of the drive over the second half of `frames` frames drawn from the law itself with the drive
/// `truth`.
Vector3d settled_drive(ForceMotion motion, const Vector3d& truth, double rate_Hz, int frames, unsigned seed) {
  Draws draws(seed);
  const MotionModel model(law(motion));
  test::DrawnMotion force(model, draws);
  ProcessNoise noise(model, ProcessNoiseOptions::of(motion));
  MotionStep step;
  step.drive = truth;
  Vector3d sum = Vector3d::Zero();
  for (int k = 0; k < frames; ++k) {
    step.dt_s = draws.uniform(0.5, 1.5) / rate_Hz;
    force.advance(step);
    noise.predict(step.dt_s);
    if (k % 7 != 3) noise.observe(test::measure(force.seen_N(), test::tip_noise_N2(), draws), kNothing);
    if (k >= frames / 2) sum += noise.drive().array().log().matrix();
  }
  return (sum / (frames - frames / 2)).array().exp();
}

/// Within a factor 1.6, three quarters of the grid's step of 1.94 (walk) or 2.15 (velocity), where the drive moves the
/// force by more than its noise within the memory of the chain, two seconds. Uneven steps, every seventh frame missing.
TEST(ProcessNoise, FindsTheWalksDrive) {
  for (const double q : {0.02, 0.1, 0.5, 2.0}) {
    const Vector3d found = settled_drive(ForceMotion::kRandomWalk, Vector3d::Constant(q), 40.0, 4000, 81);
    for (int i = 0; i < 3; ++i) {
      EXPECT_GT(found(i), q / 1.6) << q << ' ' << i;
      EXPECT_LT(found(i), q * 1.6) << q << ' ' << i;
    }
  }
}

TEST(ProcessNoise, FindsTheVelocitysDrive) {
  for (const double q : {0.25, 1.0, 4.0, 16.0}) {
    const Vector3d found = settled_drive(ForceMotion::kConstantVelocity, Vector3d::Constant(q), 40.0, 4000, 82);
    for (int i = 0; i < 3; ++i) {
      EXPECT_GT(found(i), q / 1.6) << q << ' ' << i;
      EXPECT_LT(found(i), q * 1.6) << q << ' ' << i;
    }
  }
}

/// Drives that hardly show over the noise (0.005 N/sqrt(s) moves 0.8 mN a frame, the noise is 4 and 9 mN): the mean of
/// q^2 errs to the large side, by what a change of regime adds a frame; a factor 3 at most, and never to the small side
/// by more than 1.6.
TEST(ProcessNoise, ErrsToTheLargeSideWhereTheDriveHardlyShows) {
  for (const auto& [motion, q] : {std::pair(ForceMotion::kRandomWalk, 0.005), std::pair(ForceMotion::kRandomWalk, 0.01),
                                  std::pair(ForceMotion::kConstantVelocity, 0.1)}) {
    const Vector3d found = settled_drive(motion, Vector3d::Constant(q), 40.0, 4000, 83);
    for (int i = 0; i < 3; ++i) {
      EXPECT_GT(found(i), q / 1.6) << q << ' ' << i;
      EXPECT_LT(found(i), q * 3.0) << q << ' ' << i;
    }
  }
}

TEST(ProcessNoise, EveryAxisHasItsOwn) {
  const Vector3d truth(0.02, 0.5, 2.0);
  const Vector3d found = settled_drive(ForceMotion::kRandomWalk, truth, 40.0, 4000, 84);
  for (int i = 0; i < 3; ++i) {
    EXPECT_GT(found(i), truth(i) / 1.6) << i;
    EXPECT_LT(found(i), truth(i) * 1.6) << i;
  }
}

TEST(ProcessNoise, WorksFromTenToAThousandHertz) {
  for (const double rate_Hz : {10.0, 100.0, 1000.0}) {
    const int frames = static_cast<int>(60.0 * rate_Hz);
    const Vector3d found = settled_drive(ForceMotion::kConstantVelocity, Vector3d::Ones(), rate_Hz, frames, 85);
    for (int i = 0; i < 3; ++i) {
      EXPECT_GT(found(i), 1.0 / 1.6) << rate_Hz << ' ' << i;
      EXPECT_LT(found(i), 1.6) << rate_Hz << ' ' << i;
    }
  }
}

/// A force at rest, ten seconds: the drive of each axis falls to less than a tenth of the prior's; what remains is what
/// the chain lets in anew with every frame. Then it moves: within five frames of a step of ten sigmas a frame the drive
/// is at least ten times larger.
TEST(ProcessNoise, FallsAtRestAndRisesWithinFiveFrames) {
  Draws draws(86);
  const MotionModel model(law(ForceMotion::kConstantVelocity));
  ProcessNoise noise(model, ProcessNoiseOptions::of(ForceMotion::kConstantVelocity));
  const auto frame = [&](const Vector3d& force_N) {
    noise.predict(0.025);
    noise.observe(test::measure(force_N, test::tip_noise_N2(), draws), kNothing);
  };
  for (int k = 0; k < 400; ++k) frame(Vector3d(0.0, 0.1, -0.1));
  const Vector3d rest = noise.drive();
  EXPECT_LT(rest.maxCoeff(), 0.1);
  for (int k = 1; k <= 5; ++k) frame(Vector3d(0.0, 0.1, -0.1) + 0.05 * k * Vector3d::Ones());
  for (int i = 0; i < 3; ++i) EXPECT_GT(noise.drive()(i), 10.0 * rest(i)) << i;
}

/// A jump that is announced says nothing about the drive; one that is not, says a lot.
TEST(ProcessNoise, AnAnnouncedJumpDoesNotCount) {
  const MotionModel model(law(ForceMotion::kConstantVelocity));
  for (const bool announced : {true, false}) {
    Draws draws(87);
    ProcessNoise noise(model, ProcessNoiseOptions::of(ForceMotion::kConstantVelocity));
    Vector3d force_N = Vector3d::Zero();
    double largest = 0.0;
    for (int k = 0; k < 1200; ++k) {
      const bool jumps = k > 0 && k % 20 == 0;
      if (jumps) force_N = draws.in_ball(0.3);
      noise.predict(0.025);
      if (jumps && announced) noise.jump();
      noise.observe(test::measure(force_N, test::tip_noise_N2(), draws), kNothing);
      if (k > 400 && k % 20 > 0) largest = std::max(largest, noise.drive().y());
    }
    EXPECT_EQ(largest < 1.0, announced) << largest;
  }
}

/// z never seen, for an hour: its drive stays the prior's, the followers stay finite, and the other axes are found as
/// if nothing were amiss. Seen at last, z is found as well.
TEST(ProcessNoise, AnAxisThatIsNotSeenStaysAtThePrior) {
  Draws draws(88);
  const MotionModel model(law(ForceMotion::kConstantVelocity));
  ProcessNoise noise(model, ProcessNoiseOptions::of(ForceMotion::kConstantVelocity));
  const double prior = noise.drive().z();
  const Vector3d truth(0.0, 0.1, 0.1);
  for (int k = 0; k < 3600 * 10; ++k) {
    noise.predict(0.1);
    ForceLikelihood y = test::measure(truth, 1e-6 * Matrix3d::Identity(), draws);
    y.information_per_N2.row(2).setZero();
    y.information_per_N2.col(2).setZero();
    y.information_mean_per_N.z() = 0.0;
    noise.observe(y, kNothing);
  }
  EXPECT_NEAR(noise.drive().z() / prior, 1.0, 0.05);
  EXPECT_LT(noise.drive().y(), 0.1 * prior);
  for (int k = 0; k < 400; ++k) {
    noise.predict(0.1);
    noise.observe(test::measure(truth, 1e-6 * Matrix3d::Identity(), draws), kNothing);
  }
  EXPECT_LT(noise.drive().z(), 0.1 * prior);
}

TEST(ProcessNoise, PassesOverWhatIsNotFinite) {
  const MotionModel model(law(ForceMotion::kRandomWalk));
  ProcessNoise noise(model, ProcessNoiseOptions::of(ForceMotion::kRandomWalk));
  const Vector3d before = noise.drive();
  ForceLikelihood bad;
  bad.information_mean_per_N.setConstant(std::numeric_limits<double>::quiet_NaN());
  noise.observe(bad, kNothing);
  bad.information_per_N2.setConstant(std::numeric_limits<double>::infinity());
  noise.observe(bad, kNothing);
  EXPECT_EQ(noise.drive(), before);
}

/// A disturbance that is declared is not taken for a movement of the force: noise of 10 mN that lasts 0.1 s.
TEST(ProcessNoise, ADeclaredDisturbanceDoesNotCount) {
  Draws draws(89);
  MotionOptions options = law(ForceMotion::kConstantVelocity);
  options.disturbance_rms_N.setConstant(0.01);
  const MotionModel disturbed(options), ignorant(law(ForceMotion::kConstantVelocity));
  const ProcessNoiseOptions settings;
  ProcessNoise knows(disturbed, settings), does_not(ignorant, settings);
  test::DrawnMotion force(disturbed, draws);
  MotionStep step;
  step.dt_s = 0.025;
  for (int k = 0; k < 2000; ++k) {
    force.advance(step);
    const ForceLikelihood y = test::measure(force.seen_N(), 1e-6 * Matrix3d::Identity(), draws);
    for (ProcessNoise* noise : {&knows, &does_not}) {
      noise->predict(step.dt_s);
      noise->observe(y, kNothing);
    }
  }
  EXPECT_LT(knows.drive().maxCoeff(), 0.2);
  EXPECT_GT(does_not.drive().minCoeff(), 0.5);
}

TEST(ProcessNoise, OptionsOutOfRangeAreRefused) {
  const MotionModel model(MotionOptions{});
  ProcessNoiseOptions options;
  options.prior_drive = 100.0;
  EXPECT_THROW(ProcessNoise(model, options), InputError);
  options = {};
  options.least_drive = 0.0;
  EXPECT_THROW(ProcessNoise(model, options), InputError);
  options = {};
  options.drift_per_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ProcessNoise(model, options), InputError);
}

}  // namespace
}  // namespace palpate
