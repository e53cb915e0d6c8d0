// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/identification/tare.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <tests/sensing/virtual_setups.hpp>

namespace palpate {
namespace {

using test::Draws;

constexpr TareInterval kAll{.from_s = 0.0, .to_s = 1e9};

std::vector<TrackerFrame> unloaded(const Catheter& catheter, std::uint64_t seed = 1, double duration_s = 1.0) {
  const auto no_force = [](double) -> Vector3d { return Vector3d::Zero(); };
  return simulate_tracker(catheter, no_force, {.duration_s = duration_s, .seed = seed}).frames;
}

Catheter uncertain(Catheter catheter) {
  catheter.base.position_sigma_m = 1e-3;
  catheter.base.rotation_sigma_rad = 1.0 * kRadiansPerDegree;
  catheter.precurvature_sigma_per_m = {1.0, 0.5, 0.3};
  return catheter;
}

/// A setup that differs from what its catheter file states: the clamp by (turn, shift), precurvature by `bend`.
struct Error {
  Vector3d shift_m = Vector3d::Zero(), turn_rad = Vector3d::Zero(), bend_per_m = Vector3d::Zero();

  Catheter put_into(Catheter stated) const {
    stated.base.T_tracker_base = stated.base.T_tracker_base * Pose{Draws::turn(turn_rad), shift_m};
    stated.rod.sections[0].precurvature_per_m += bend_per_m;
    return stated;
  }
};

Error drawn(const Catheter& stated, Draws& draws) {
  return {stated.base.position_sigma_m * draws.normal3(), stated.base.rotation_sigma_rad * draws.normal3(),
          stated.precurvature_sigma_per_m.cwiseProduct(draws.normal3())};
}

/// Errors drawn from what the file states, noise from what the sensors state: then the posterior's sigmas are true. Of
/// 100 seeds 95.4 lie within 2 sigma, +- 2.1; 3.5 of those below is 88. The base's sigmas are given as one rms: its
/// squared error over 3 sigma^2 has mean 1 with a scatter of at most sqrt(2 / 100) = 0.14.
TEST(Tare, ErrorsThatRemainAreWithinTheSigmasItGives) {
  constexpr int kSeeds = 100;
  const Catheter stated = uncertain(test::two_sensors());
  Draws draws(81);
  Eigen::Array3d within = Eigen::Array3d::Zero();
  double shift = 0.0, turn = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Error error = drawn(stated, draws);
    const Tare found = tare(stated, unloaded(error.put_into(stated), static_cast<std::uint64_t>(seed), 0.5), kAll);
    const Catheter& c = found.catheter;
    const Eigen::Array3d bend_error = (found.precurvature_change_per_m - error.bend_per_m).array().abs();
    within += (bend_error <= 2.0 * c.precurvature_sigma_per_m.array()).cast<double>();
    shift += (found.base_shift_m - error.shift_m).squaredNorm() / (3.0 * std::pow(c.base.position_sigma_m, 2));
    turn += (found.base_rotation_rad - error.turn_rad).squaredNorm() / (3.0 * std::pow(c.base.rotation_sigma_rad, 2));
    EXPECT_TRUE((c.precurvature_sigma_per_m.array() <= stated.precurvature_sigma_per_m.array()).all());
    EXPECT_LE(c.base.position_sigma_m, stated.base.position_sigma_m);
    EXPECT_LE(c.base.rotation_sigma_rad, stated.base.rotation_sigma_rad);
  }
  for (int axis = 0; axis < 3; ++axis) EXPECT_GE(within(axis), 88.0);
  EXPECT_NEAR(shift / kSeeds, 1.0, 0.5);
  EXPECT_NEAR(turn / kSeeds, 1.0, 0.5);
}

/// Three sensors spread along the shaft, hardly any noise, wide priors: the errors themselves must come out.
TEST(Tare, FindsBaseAndPrecurvatureWhereTheSensorsSeeThem) {
  Catheter stated = test::two_sensors();
  stated.sensors.push_back(test::sensor_at("middle", 0.035));
  stated.sensors.push_back(test::sensor_at("first", 0.01));
  for (Sensor& sensor : stated.sensors) sensor.noise_m.setConstant(1e-7), sensor.noise_rad = 1e-6;
  stated.base.position_sigma_m = 0.05;
  stated.base.rotation_sigma_rad = 0.5;
  stated.precurvature_sigma_per_m.setConstant(20.0);
  for (const bool heavy : {false, true}) {
    SCOPED_TRACE(heavy ? "own weight" : "no weight");
    const Catheter catheter = heavy ? test::with_own_weight(stated) : stated;
    const Error error{{3e-3, -2e-3, 5e-3}, {0.1, -0.2, 0.15}, {2.0, -1.5, 1.0}};
    Catheter real = error.put_into(catheter);
    // the weight hangs along the same direction in the tracker's frame, wherever the clamp really stands
    real.rod.distributed_load_base_N_per_m =
        Draws::turn(error.turn_rad).transpose() * catheter.rod.distributed_load_base_N_per_m;
    Tare found;
    ASSERT_NO_THROW(found = tare(catheter, unloaded(real), kAll));
    EXPECT_LT((found.base_shift_m - error.shift_m).norm(), 1e-6);
    EXPECT_LT((found.base_rotation_rad - error.turn_rad).norm(), 1e-5);
    EXPECT_LT((found.precurvature_change_per_m - error.bend_per_m).norm(), 1e-3);
    EXPECT_GT(found.residual_before_m, 1e-3);
    EXPECT_LT(found.residual_after_m, 1e-6);
    EXPECT_EQ(found.frames, 40);
    EXPECT_LT((found.catheter.base.T_tracker_base.p - real.base.T_tracker_base.p).norm(), 1e-6);
    EXPECT_LT((found.catheter.base.T_tracker_base.R - real.base.T_tracker_base.R).norm(), 1e-5);
    EXPECT_LT((found.catheter.rod.sections[0].precurvature_per_m - real.rod.sections[0].precurvature_per_m).norm(),
              1e-3);
    EXPECT_LT((found.catheter.rod.distributed_load_base_N_per_m - real.rod.distributed_load_base_N_per_m).norm(), 1e-5);
  }
}

TEST(Tare, WhatHasSigmaZeroStaysAsItIs) {
  const Catheter stated = test::two_sensors();
  Catheter real = Error{{1e-3, 0, 0}, {0, 0.02, 0}, {1.0, 0, 0}}.put_into(stated);
  const Tare found = tare(stated, unloaded(real), kAll);
  EXPECT_LT(found.base_shift_m.norm(), 1e-12);
  EXPECT_LT(found.base_rotation_rad.norm(), 1e-12);
  EXPECT_LT(found.precurvature_change_per_m.norm(), 1e-9);
  EXPECT_EQ(found.catheter.base.position_sigma_m, 0.0);
  EXPECT_EQ(found.catheter.base.rotation_sigma_rad, 0.0);
  EXPECT_EQ(found.catheter.precurvature_sigma_per_m, Vector3d::Zero());
  EXPECT_NO_THROW(found.catheter.validate());
}

TEST(Tare, OneAxisOfPrecurvatureMayBeKnownExactly) {
  Catheter stated = uncertain(test::two_sensors());
  stated.precurvature_sigma_per_m = {1.0, 0.0, 0.0};
  Draws draws(82);
  const Tare found = tare(stated, unloaded(drawn(stated, draws).put_into(stated)), kAll);
  EXPECT_GT(found.precurvature_change_per_m.cwiseAbs()(0), 0.01);
  EXPECT_LT(found.precurvature_change_per_m.tail<2>().norm(), 1e-9);
  EXPECT_EQ((found.catheter.precurvature_sigma_per_m.tail<2>()), Eigen::Vector2d::Zero());
}

TEST(Tare, TrackedBaseStaysAndThePrecurvatureIsFound) {
  const Catheter stated = test::with_tracked_base(uncertain(test::two_sensors()));
  const Error error{Vector3d::Zero(), Vector3d::Zero(), {1.5, 0.0, 0.0}};
  const Tare found = tare(stated, unloaded(error.put_into(stated)), kAll);
  EXPECT_LT(found.base_shift_m.norm(), 1e-12);
  EXPECT_NEAR(found.precurvature_change_per_m.x(), 1.5, 4.0 * found.catheter.precurvature_sigma_per_m.x());
  EXPECT_EQ(found.catheter.base.position_sigma_m, stated.base.position_sigma_m);
  EXPECT_EQ(found.catheter.base.rotation_sigma_rad, stated.base.rotation_sigma_rad);
}

/// Points on a straight line see the clamp's shift and its tilt; a turn about the line they cannot see.
TEST(Tare, StraightReferenceFromPointsAlone) {
  Catheter stated = uncertain(test::two_sensors(SensorKind::kPosition));
  stated.sensors[1].arc_length_m = 0.02;
  for (Sensor& sensor : stated.sensors) sensor.noise_m.setConstant(1e-6);
  stated = test::with_own_weight(stated);  // held by hand: it does not bend
  Catheter straight = stated;
  straight.rod.sections[0].precurvature_per_m.setZero();
  straight.rod.distributed_load_base_N_per_m.setZero();
  const Error error{{0.5e-3, -1e-3, 0.0}, {0.01, -0.005, 0.0}, Vector3d::Zero()};
  const Tare found = tare(stated, unloaded(error.put_into(straight)), {.from_s = 0.0, .to_s = 1e9, .straight = true});
  EXPECT_LT((found.base_shift_m - error.shift_m).norm(), 1e-5);
  EXPECT_LT((found.base_rotation_rad - error.turn_rad).norm(), 1e-4);
  EXPECT_LT(found.precurvature_change_per_m.norm(), 1e-9);
  EXPECT_EQ(found.catheter.rod.sections[0].precurvature_per_m, stated.rod.sections[0].precurvature_per_m);
  EXPECT_EQ(found.catheter.precurvature_sigma_per_m, stated.precurvature_sigma_per_m);
  EXPECT_GT(found.catheter.base.rotation_sigma_rad, 0.5 * stated.base.rotation_sigma_rad) << "roll stays unknown";
}

TEST(Tare, OnlyTheIntervalCounts) {
  const Catheter stated = uncertain(test::two_sensors());
  std::vector<TrackerFrame> frames = unloaded(stated, 3, 2.0);
  const Tare expected = tare(stated, std::span(frames).subspan(20, 21), kAll);
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (i < 20 || i > 40) frames[i].readings[0].position_m.x() += 1.0;
  const Tare found = tare(stated, frames, {.from_s = 0.5, .to_s = 1.0});
  EXPECT_EQ(found.frames, 21);
  EXPECT_EQ(found.base_shift_m, expected.base_shift_m);
}

TEST(Tare, GrossOutliersDoNotMoveIt) {
  const Catheter catheter = uncertain(test::two_sensors());
  std::vector<TrackerFrame> frames = unloaded(catheter, 3, 2.0);
  const Tare clean = tare(catheter, frames, kAll);
  frames[5].readings[0].position_m.x() += 0.025;
  frames[9].readings[0].position_m.y() = 1e200;
  frames[20].readings[1].quaternion_wxyz = Eigen::Vector4d(0.5, 0.5, 0.5, 0.5);
  const Tare spoilt = tare(catheter, frames, kAll);
  EXPECT_EQ(clean.outliers, 0);
  EXPECT_EQ(spoilt.outliers, 3);
  EXPECT_LT((spoilt.precurvature_change_per_m - clean.precurvature_change_per_m).norm(), 0.1);
  EXPECT_LT((spoilt.base_shift_m - clean.base_shift_m).norm(), 1e-4);
}

/// What [base] has wrong is wrong in its own tracker: a sensor of another one keeps its registration, and still tells
/// of the precurvature. The weight bends the shaft too, and turns with the clamp.
TEST(Tare, ASensorOfAnotherTrackerKeepsItsRegistration) {
  Catheter stated = test::with_second_tracker(uncertain(test::two_sensors()));
  stated.rod.distributed_load_base_N_per_m = {0.05, -0.3, 0.1};
  const Error error{.shift_m = {1e-3, -1e-3, 0.5e-3}, .turn_rad = {0.01, 0.015, 0.0}, .bend_per_m = {0.8, -0.4, 0.0}};
  Catheter truth = error.put_into(stated);
  truth.rod.distributed_load_base_N_per_m =
      truth.base.T_tracker_base.R.transpose() * stated.base.T_tracker_base.R * stated.rod.distributed_load_base_N_per_m;
  const Tare found = tare(stated, unloaded(truth, 3, 10.0), kAll);
  EXPECT_EQ(found.catheter.sensors[1].T_tracker_base->p, stated.sensors[1].T_tracker_base->p);
  EXPECT_EQ(found.catheter.sensors[1].T_tracker_base->R, stated.sensors[1].T_tracker_base->R);
  const Catheter& c = found.catheter;
  EXPECT_LT((found.base_shift_m - error.shift_m).cwiseAbs().maxCoeff(), 4.0 * c.base.position_sigma_m);
  EXPECT_LT((found.base_rotation_rad - error.turn_rad).cwiseAbs().maxCoeff(), 4.0 * c.base.rotation_sigma_rad);
  for (int i = 0; i < 3; ++i)
    EXPECT_LT(std::abs(found.precurvature_change_per_m(i) - error.bend_per_m(i)), 4.0 * c.precurvature_sigma_per_m(i));
  EXPECT_LT(c.precurvature_sigma_per_m.x(), 0.2) << "the registered sensor sees the bend";
  EXPECT_LT(found.residual_after_m, 0.1e-3);
  EXPECT_GT(found.residual_before_m, 1e-3);
}

/// Where every sensor has a registration of its own, the weight alone tells how the clamp is turned: across it, not
/// about.
TEST(Tare, TheWeightShowsATurnOfTheClampToSensorsThatAreRegistered) {
  for (const SensorKind kind : {SensorKind::kPose, SensorKind::kPosition}) {
    Catheter stated = test::with_own_weight(test::two_sensors());
    for (Sensor& sensor : stated.sensors) {
      sensor.T_tracker_base = test::some_mounting();
      sensor.kind = kind;
    }
    stated.base.rotation_sigma_rad = 0.1;
    const Vector3d weight = stated.rod.distributed_load_base_N_per_m, down = weight.normalized();
    const Vector3d turn_rad = 0.1 * down.unitOrthogonal() - 0.05 * down.cross(down.unitOrthogonal());
    Catheter truth = stated;
    truth.rod.distributed_load_base_N_per_m = Draws::turn(turn_rad).transpose() * weight;
    const Tare found = tare(stated, unloaded(truth, 3, 10.0), kAll);
    EXPECT_LT((found.catheter.rod.distributed_load_base_N_per_m.normalized() -
               truth.rod.distributed_load_base_N_per_m.normalized())
                  .norm(),
              5e-3);
    EXPECT_GT(found.residual_before_m, 0.25e-3);
    EXPECT_LT(found.residual_after_m, 0.05e-3);
    EXPECT_EQ(found.base_shift_m, Vector3d::Zero());
  }
}

/// A tendon's couple bends the shaft meanwhile; taken for precurvature it would act twice afterwards.
TEST(Tare, TendonIsALoadAndNoPrecurvature) {
  Catheter bent = uncertain(test::two_sensors());
  Catheter pulled = bent;
  pulled.tendon.present = true;
  pulled.rod.sections[0].precurvature_per_m.setZero();
  const Section& section = bent.rod.sections[0];
  const Vector3d couple = section.stiffness_Nm2.cwiseProduct(section.precurvature_per_m);
  std::vector<TrackerFrame> frames = unloaded(bent, 5);
  for (TrackerFrame& frame : frames) frame.tendon = {.present = true, .moment_Nm = couple.head<2>(), .sigma_Nm = 0.0};
  const Tare found = tare(pulled, frames, kAll);
  EXPECT_LT(found.largest_change_sigmas, 4.0);
  EXPECT_LT(found.precurvature_change_per_m.norm(), 1.0);
}

TEST(Tare, ALoadedIntervalIsSuspicious) {
  const Catheter catheter = uncertain(test::two_sensors());
  const auto push = [](double) -> Vector3d { return {0.0, 0.1, -0.1}; };
  const auto loaded = simulate_tracker(catheter, push, {.duration_s = 1.0}).frames;
  EXPECT_GT(tare(catheter, loaded, kAll).largest_change_sigmas, 4.0);
}

TEST(Tare, NothingUsableInTheIntervalIsRefused) {
  const Catheter stated = uncertain(test::two_sensors());
  std::vector<TrackerFrame> frames = unloaded(stated);
  const auto error = [&](const TareInterval& interval) -> std::string {
    try {
      tare(stated, frames, interval);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_EQ(error({.from_s = 5.0, .to_s = 7.0}), "reference 5:7 s: no usable frame in the interval");
  EXPECT_EQ(error({.from_s = 1.0, .to_s = 0.0}), "reference 1:0 s: no usable frame in the interval");
  for (TrackerFrame& frame : frames)
    for (SensorReading& reading : frame.readings) reading = SensorReading{};
  EXPECT_EQ(error({.from_s = 0.0, .to_s = 1.0}), "reference 0:1 s: no usable frame in the interval");
}

}  // namespace
}  // namespace palpate
