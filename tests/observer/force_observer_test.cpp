// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/math/errors.hpp>
#include <tests/observer/runs.hpp>

namespace palpate {
namespace {

using test::Draws;

/// 100 jumps of 0.2 N in any direction between frames. The estimate of the very next frame is an update and lies within
/// 4.5 sigma of the new force on each axis (600 draws: at 4 sigma one in 27 such tests would fail by chance).
TEST(ForceObserver, JumpIsFollowedOnTheNextFrame) {
  for (const Method method : {Method::kIekf, Method::kIaekf}) {
    const Catheter catheter = test::two_sensors();
    Draws draws(71);
    int used_both = 0;
    for (int trial = 0; trial < 100; ++trial) {
      ForceObserver observer(catheter, {.method = method});
      const Vector3d before = draws.in_ball(0.05), after = before + 0.2 * draws.normal3().normalized();
      double time_s = 0.0;
      for (int i = 0; i < 10; ++i, time_s += 0.025)
        observer.update(test::with_noise(catheter, test::exact_frame(catheter, before, time_s), draws));
      const Estimate e = observer.update(test::with_noise(catheter, test::exact_frame(catheter, after, time_s), draws));
      EXPECT_LE(e.status, EstimateStatus::kReseeded) << "trial " << trial << ", to " << after.transpose();
      used_both += e.sensors_used == 2 ? 1 : 0;
      const Eigen::Array3d sigma = e.covariance_tip_N2.diagonal().array().sqrt();
      EXPECT_TRUE(((e.force_tip_N - after).array().abs() <= 4.5 * sigma).all()) << "trial " << trial;
    }
    EXPECT_GE(used_both, 98) << "a good sensor is hardly ever blamed for a jump";
  }
}

/// A force well inside what is believed before any frame (0.3 N an axis) is no jump, though its fit may be given up on
/// the way: of 300 draws of 0.1 N an axis, those lost where no fit from the prediction ends are allowed for.
TEST(ForceObserver, TheFirstForceIsNoJump) {
  const Catheter catheter = test::two_sensors();
  Draws draws(72);
  int jumps = 0;
  for (int i = 0; i < 300; ++i) {
    const TrackerFrame frame =
        test::with_noise(catheter, test::exact_frame(catheter, 0.1 * draws.normal3(), 0.0), draws);
    jumps += ForceObserver(catheter, {}).update(frame).jumped ? 1 : 0;
  }
  EXPECT_LE(jumps, 12);
}

TEST(ForceObserver, PapersMeasurementVectorWorksToo) {
  const Catheter catheter = test::two_sensors();
  const auto recording = simulate_tracker(catheter, turning_force(0.1, 10.0), {.duration_s = 10.0});
  const auto estimates = test::run(catheter, {.measurement = MeasurementKind::kTipAndCurvature}, recording.frames);
  for (const Estimate& e : estimates) EXPECT_EQ(e.dof, 9);
  EXPECT_GE(test::share_within(4.0, estimates, recording), 0.99);
}

TEST(ForceObserver, RawPosesKnowMoreThanThePapersVector) {
  const Catheter catheter = test::two_sensors();
  const TrackerFrame frame = test::exact_frame(catheter, Vector3d::Zero());
  ForceObserver raw(catheter, {}), paper(catheter, {.measurement = MeasurementKind::kTipAndCurvature});
  const Matrix3d P_raw = raw.update(frame).covariance_tip_N2, P_paper = paper.update(frame).covariance_tip_N2;
  EXPECT_LT(P_raw.determinant(), P_paper.determinant());
}

/// What the sensors cannot tell returns to zero with the spread stated, instead of drifting without bound.
TEST(ForceObserver, GaussMarkovForceForgetsToItsStatedSpread) {
  const Catheter catheter = test::two_sensors();
  ForceObserver observer(
      catheter, {.force_model = ForceMotion::kGaussMarkov, .force_memory_s = 0.2, .initial_force_sigma_N = 0.1});
  TrackerFrame frame = test::exact_frame(catheter, Vector3d(0.0, 0.0, -0.1), 0.0);
  const Vector3d seen = observer.update(frame).force_tip_N;
  for (SensorReading& reading : frame.readings) reading.status = SensorReading::Status::kMissing;
  frame.time_s = 0.2;
  const Estimate later = observer.update(frame);
  EXPECT_LT((later.force_tip_N - std::exp(-1.0) * seen).norm(), 1e-12);
  for (frame.time_s = 1.0; frame.time_s < 10.0; frame.time_s += 0.5) observer.update(frame);
  const Estimate forgotten = observer.update(frame);
  EXPECT_LT(forgotten.force_tip_N.norm(), 1e-9);
  EXPECT_LT((forgotten.covariance_tip_N2 - 0.01 * Matrix3d::Identity()).norm(), 1e-9);
}

/// After a gap everything may have happened, but no more than right after a jump: sqrt(2) times the spread before the
/// first frame.
TEST(ForceObserver, ALongGapForgetsEverythingAndNoMore) {
  const Catheter catheter = test::two_sensors();
  for (const ForceMotion motion : {ForceMotion::kRandomWalk, ForceMotion::kConstantVelocity, ForceMotion::kRhythm}) {
    ForceObserver observer(catheter, {.force_model = motion, .initial_force_sigma_N = 0.3});
    TrackerFrame frame = test::exact_frame(catheter, {0.0, 0.05, -0.1}, 0.0);
    observer.update(frame);
    for (SensorReading& reading : frame.readings) reading.status = SensorReading::Status::kMissing;
    frame.time_s = 3600.0;
    const Estimate e = observer.update(frame);
    EXPECT_LT((e.covariance_tip_N2 - 0.18 * Matrix3d::Identity()).norm(), 1e-3);
    EXPECT_LT(e.force_tip_N.norm(), 1e-3);
  }
}

/// One linear step may end anywhere; what does not explain the frame must not become the state.
TEST(ForceObserver, EkfKeepsTheIteratedFitWhereItsStepFails) {
  const Catheter catheter = test::two_sensors();
  Draws draws(72);
  int reseeded = 0;
  for (int trial = 0; trial < 50; ++trial) {
    ForceObserver observer(catheter, {.method = Method::kEkf});
    const Vector3d force = 0.2 * draws.normal3().normalized();
    observer.update(test::exact_frame(catheter, Vector3d::Zero(), 0.0));
    const Estimate e = observer.update(test::exact_frame(catheter, force, 0.025));
    reseeded += e.status == EstimateStatus::kReseeded ? 1 : 0;
    if (e.used == 0) continue;
    const Eigen::Array3d sigma = e.covariance_tip_N2.diagonal().array().sqrt();
    EXPECT_TRUE(((e.force_tip_N - force).array().abs() <= 6.0 * sigma).all()) << "trial " << trial;
  }
  EXPECT_GT(reseeded, 0) << "else nothing was tested";
}

/// A point gives three numbers a frame for three unknowns; what it cannot see keeps its wide sigma.
TEST(ForceObserver, SinglePositionSensorIsEnoughForAnHonestEstimate) {
  Catheter catheter = test::bare_catheter();
  catheter.sensors = {test::sensor_at("tip", 0.07, SensorKind::kPosition)};
  const auto recording = simulate_tracker(catheter, turning_force(0.05, 10.0), {.duration_s = 10.0});
  const auto estimates = test::run(catheter, {}, recording.frames);
  for (const Estimate& e : estimates) EXPECT_EQ(e.dof, 3);
  EXPECT_GE(test::share_within(4.0, estimates, recording), 0.98);
}

TEST(ForceObserver, OwnWeightIsNotMistakenForAForce) {
  const Catheter heavy = test::with_own_weight(test::two_sensors());
  const auto recording = simulate_tracker(heavy, turning_force(0.08, 10.0), {.duration_s = 6.0});
  EXPECT_GE(test::share_within(4.0, test::run(heavy, {}, recording.frames), recording), 0.99);
  Catheter light = heavy;
  light.rod.distributed_load_base_N_per_m.setZero();
  EXPECT_LT(test::share_within(4.0, test::run(light, {}, recording.frames), recording), 0.5) << "the check can fail";
}

/// One rod bent by its tendon (couple EI1 k1), one by an equal precurvature: same readings, same estimates.
TEST(ForceObserver, TendonCoupleIsThePrecurvatureItMakes) {
  const Catheter bent = test::two_sensors();
  Catheter pulled = bent;
  Section& section = pulled.rod.sections[0];
  const double moment_Nm = section.stiffness_Nm2.x() * section.precurvature_per_m.x();
  section.precurvature_per_m.setZero();
  pulled.tendon.present = true;
  auto recording = simulate_tracker(bent, beating_wall_force, {.duration_s = 3.0});
  const auto by_precurvature = test::run(bent, {}, recording.frames);
  for (TrackerFrame& frame : recording.frames)
    frame.tendon = {.present = true, .moment_Nm = {moment_Nm, 0.0}, .sigma_Nm = 0.0};
  const auto by_tendon = test::run(pulled, {}, recording.frames);
  for (std::size_t i = 0; i < by_tendon.size(); ++i) {
    EXPECT_EQ(by_tendon[i].status, EstimateStatus::kUpdated);
    // the real-time setting's steps differ a little between the two: 1e-6 of the length, against 5 mm a 0.1 N
    EXPECT_LT((by_tendon[i].force_tip_N - by_precurvature[i].force_tip_N).norm(), 1e-4);
  }
}

TEST(ForceObserver, EstimateAccountsForItsFrame) {
  const Catheter catheter = test::mixed_sensors();
  ForceObserver observer(catheter, {.report_convergence_index = true});
  const Estimate e = observer.update(test::exact_frame(catheter, Vector3d::Zero(), 12.5));
  EXPECT_EQ(e.time_s, 12.5);
  EXPECT_EQ(e.time, FrameTime::kFirst);
  EXPECT_EQ(e.used, 0b111U);
  EXPECT_EQ(e.sensors_used, 3);
  EXPECT_EQ(e.dof, 14);
  EXPECT_GE(e.evaluations, 1);
  EXPECT_LT(e.nis, 1e-3) << "exact readings, right prediction";
  EXPECT_GE(e.convergence.normalised, 0.0);
  for (const Rejection r : e.rejections) EXPECT_EQ(r, Rejection::kNone);
}

/// Filtered over time, the squared innovations of a matched filter have the mean of their degrees of freedom. The force
/// walks at random as the filter believes; 12 x 400 samples scatter by sqrt(2 / 4800) = 2 %. NEES: neighbouring frames
/// are alike for a few frames: 400 frames are worth 100 or more, 3 +- 0.25 (one sigma).
TEST(ForceObserver, IsConsistentOnTheForceItBelievesIn) {
  const Catheter catheter = test::two_sensors();
  Draws draws(72);
  std::vector<Vector3d> walk{Vector3d::Zero()};
  for (int i = 1; i < 400; ++i) walk.emplace_back(walk.back() + 0.05 * std::sqrt(0.025) * draws.normal3());
  const ForceSchedule schedule = [&](double time_s) {
    return walk[static_cast<std::size_t>(std::lround(40.0 * time_s))];
  };
  const auto recording = simulate_tracker(catheter, schedule, {.duration_s = 10.0});
  const auto estimates =
      test::run(catheter, {.force_model = ForceMotion::kRandomWalk, .force_rate_N_per_sqrt_s = 0.05}, recording.frames);
  double nis = 0.0, nees = 0.0;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    nis += estimates[i].nis / estimates[i].dof / 400.0;
    nees += test::nees(estimates[i], recording.force_tip_N[i]) / 400.0;
  }
  EXPECT_NEAR(nis, 1.0, 0.08);
  EXPECT_NEAR(nees, 3.0, 0.75);
}

TEST(ForceObserver, UnusableOptionsAndCathetersAreRefused) {
  EXPECT_THROW(ForceObserver(test::two_sensors(), {.max_iterations = 0}), InputError);
  EXPECT_THROW(ForceObserver(test::two_sensors(), {.outlier_probability = 0.0}), InputError);
  EXPECT_THROW(ForceObserver(test::bare_catheter(), {}), InputError);
}

}  // namespace
}  // namespace palpate
