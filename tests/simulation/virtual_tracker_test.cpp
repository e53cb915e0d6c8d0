// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <palpate/math/errors.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <tests/sensing/virtual_setups.hpp>

namespace palpate {
namespace {

ForceSchedule constant(const Vector3d& force) {
  return [=](double) { return force; };
}

bool same_bytes(const VirtualRecording& a, const VirtualRecording& b) {
  for (std::size_t i = 0; i < a.frames.size(); ++i)
    for (std::size_t k = 0; k < a.frames[i].readings.size(); ++k) {
      const SensorReading &x = a.frames[i].readings[k], &y = b.frames[i].readings[k];
      if (x.status != y.status || x.has_orientation != y.has_orientation) return false;
      if (std::memcmp(x.position_m.data(), y.position_m.data(), sizeof(double) * 3) != 0) return false;
      if (std::memcmp(x.quaternion_wxyz.data(), y.quaternion_wxyz.data(), sizeof(double) * 4) != 0) return false;
    }
  return a.frames.size() == b.frames.size() && a.force_tip_N == b.force_tip_N && a.force_base_N == b.force_base_N;
}

TEST(VirtualTracker, SameSeedSameBytesAnotherSeedOthers) {
  const Catheter catheter = test::with_tracked_base(test::mixed_sensors());
  VirtualTrackerOptions options{.duration_s = 1.0, .seed = 7, .missing_share = 0.1, .outlier_share = 0.1};
  const VirtualRecording first = simulate_tracker(catheter, beating_wall_force, options);
  EXPECT_TRUE(same_bytes(first, simulate_tracker(catheter, beating_wall_force, options)));
  options.seed = 8;
  EXPECT_FALSE(same_bytes(first, simulate_tracker(catheter, beating_wall_force, options)));
}

TEST(VirtualTracker, FramesAreNumberedAndTimed) {
  const auto r =
      simulate_tracker(test::two_sensors(), constant(Vector3d::Zero()), {.rate_hz = 50.0, .duration_s = 2.0});
  ASSERT_EQ(r.frames.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(r.frames[i].number, static_cast<std::int64_t>(i));
    EXPECT_DOUBLE_EQ(r.frames[i].time_s, 0.02 * static_cast<double>(i));
  }
}

/// One RodSolver, asked directly; noise of a nanometre and a microradian over a metre of lever.
TEST(VirtualTracker, PosesAreThoseOfTheRod) {
  Catheter catheter = test::mounted(test::two_sensors());
  for (Sensor& sensor : catheter.sensors) sensor.noise_m.setConstant(1e-12), sensor.noise_rad = 1e-12;
  const ForceSchedule force = turning_force(0.1, 1.0);
  const auto recording = simulate_tracker(catheter, force, {.duration_s = 1.0});
  const std::vector<double> arc_lengths_m{0.07, 0.0653};
  const RodSolver solver(catheter.rod, arc_lengths_m, Accuracy::kReference);
  auto shape = solver.make_solution<0>();
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    const Vector3d F = force(recording.frames[i].time_s);
    EXPECT_EQ(recording.force_tip_N[i], F);
    solver.solve({.force_tip_N = F}, shape);
    EXPECT_LT((recording.force_base_N[i] - shape.T_base_tip.R * F).norm(), 1e-12);
    for (std::size_t k = 0; k < 2; ++k) {
      const Pose T = catheter.base.T_tracker_base * shape.points[k].T_base_local * catheter.sensors[k].T_local_sensor;
      const SensorReading& reading = recording.frames[i].readings[k];
      EXPECT_LT((reading.position_m - T.p).norm(), 1e-10);
      EXPECT_LT((test::rotation_of(reading) - T.R).norm(), 1e-10);
    }
  }
}

TEST(VirtualTracker, BaseSensorStandsOnTheBase) {
  Catheter catheter = test::with_tracked_base(test::two_sensors());
  catheter.base.sensor.noise_m.setConstant(1e-12);
  catheter.base.sensor.noise_rad = 1e-12;
  const auto recording = simulate_tracker(catheter, constant(Vector3d::Zero()), {.duration_s = 0.1});
  const Pose T = catheter.base.T_tracker_base * catheter.base.sensor.T_local_sensor;
  for (const TrackerFrame& frame : recording.frames) {
    ASSERT_EQ(frame.readings.size(), 3U);
    EXPECT_LT((frame.readings[2].position_m - T.p).norm(), 1e-10);
    EXPECT_LT((test::rotation_of(frame.readings[2]) - T.R).norm(), 1e-10);
  }
}

/// 10000 frames at rest: a sample variance scatters by sqrt(2 / n) = 1.4 %, a mean by sigma / 100; 5 of that.
TEST(VirtualTracker, NoiseIsWhiteOfTheStatedSizeAlongTheBaseAxes) {
  constexpr double n = 10000.0;
  Catheter catheter = test::mixed_sensors();
  catheter.sensors[0].noise_m = {0.1e-3, 0.3e-3, 0.9e-3};
  const auto recording = simulate_tracker(catheter, constant(Vector3d::Zero()), {.rate_hz = 1e3, .duration_s = 10.0});
  const TrackerFrame exact = test::exact_frame(catheter, Vector3d::Zero());
  for (std::size_t k = 0; k < 3; ++k) {
    const Sensor& sensor = catheter.sensors[k];
    Eigen::Array3d mean = Eigen::Array3d::Zero(), square = mean, turn_mean = mean, turn_square = mean, lag = mean;
    Eigen::Array3d last = mean;
    for (const TrackerFrame& frame : recording.frames) {
      const SensorReading& r = frame.readings[k];
      const Vector3d shift = catheter.base.T_tracker_base.R.transpose() * (r.position_m - exact.readings[k].position_m);
      const Eigen::Array3d z = shift.array() / sensor.noise_m.array();
      mean += z / n, square += z.square() / n, lag += z * last / n;
      last = z;
      if (sensor.kind == SensorKind::kPosition) continue;
      const Eigen::AngleAxisd turn(Matrix3d(test::rotation_of(exact.readings[k]).transpose() * test::rotation_of(r)));
      const Eigen::Array3d w = turn.angle() * turn.axis().array() / sensor.noise_rad;
      turn_mean += w / n, turn_square += w.square() / n;
    }
    EXPECT_LT(mean.abs().maxCoeff(), 0.05);
    EXPECT_LT((square - 1.0).abs().maxCoeff(), 0.07);
    EXPECT_LT(lag.abs().maxCoeff(), 0.05) << "neighbouring frames are independent";
    if (sensor.kind == SensorKind::kPosition) continue;
    EXPECT_LT(turn_mean.abs().maxCoeff(), 0.05);
    EXPECT_LT((turn_square - 1.0).abs().maxCoeff(), 0.07);
  }
}

TEST(VirtualTracker, EachSensorIsSeenInItsOwnTrackersFrame) {
  const Catheter one = test::two_sensors(), two = test::with_second_tracker(one);
  const Pose to_second = *two.sensors[1].T_tracker_base * one.base.T_tracker_base.inverse();
  const auto seen = simulate_tracker(one, beating_wall_force, {.duration_s = 0.2, .seed = 3}).frames;
  const auto otherwise = simulate_tracker(two, beating_wall_force, {.duration_s = 0.2, .seed = 3}).frames;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const TrackerFrame moved = test::moved(to_second, seen[i]);
    EXPECT_LT((otherwise[i].readings[0].position_m - seen[i].readings[0].position_m).norm(), 1e-15);
    EXPECT_LT((otherwise[i].readings[1].position_m - moved.readings[1].position_m).norm(), 1e-14);
    EXPECT_LT((test::rotation_of(otherwise[i].readings[1]) - test::rotation_of(moved.readings[1])).norm(), 1e-14);
  }
}

/// 20000 readings: shares of 0.04 and 0.01 scatter by 0.0014 and 0.0007; 5 of that.
TEST(VirtualTracker, SharesOfMissingReadingsAndOutliersAreAsAsked) {
  const Catheter catheter = test::two_sensors();
  const auto recording =
      simulate_tracker(catheter, constant(Vector3d::Zero()),
                       {.rate_hz = 1e3, .duration_s = 10.0, .missing_share = 0.04, .outlier_share = 0.01});
  const TrackerFrame exact = test::exact_frame(catheter, Vector3d::Zero());
  double missing = 0.0, outliers = 0.0, present = 0.0;
  for (const TrackerFrame& frame : recording.frames)
    for (std::size_t k = 0; k < 2; ++k) {
      const SensorReading& r = frame.readings[k];
      if (r.status == SensorReading::Status::kMissing) {
        ++missing;
        continue;
      }
      ++present;
      const double shift_m = (r.position_m - exact.readings[k].position_m).norm();
      if (shift_m < 5e-3) continue;
      ++outliers;
      EXPECT_NEAR(shift_m, 25e-3, 5e-3);
    }
  EXPECT_NEAR(missing / 20000.0, 0.04, 0.007);
  EXPECT_NEAR(outliers / present, 0.01, 0.0035);
}

TEST(VirtualTracker, UnusableOptionsAreNamed) {
  const auto error = [](VirtualTrackerOptions options) -> std::string {
    try {
      simulate_tracker(test::two_sensors(), beating_wall_force, options);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_EQ(error({.rate_hz = 0.0}), "rate_hz = 0: expected more than 0, at most 10000");
  EXPECT_EQ(error({.duration_s = -1.0}), "duration_s = -1: expected more than 0, at most 86400");
  EXPECT_EQ(error({.missing_share = 1.0}), "missing_share = 1: expected 0 to below 1");
  EXPECT_EQ(error({.outlier_share = std::nan("")}), "outlier_share = nan: expected 0 to below 1");
}

TEST(Schedules, BeatingWallPushesOnlyAndLetsGoForTwoSecondsInTen) {
  double largest = 0.0;
  for (double t = 0.0; t < 30.0; t += 0.01) {
    const Vector3d F = beating_wall_force(t);
    EXPECT_LE(F.z(), 0.0);
    const bool away = std::fmod(t, 10.0) > 8.001 && std::fmod(t, 10.0) < 9.999;
    EXPECT_TRUE(!away || F.norm() == 0.0);
    largest = std::max(largest, F.norm());
  }
  EXPECT_NEAR(largest, 0.15, 0.02);
}

TEST(Schedules, TurningForceKeepsItsSizeAndPlane) {
  const ForceSchedule force = turning_force(0.2, 8.0);
  for (double t = 0.0; t < 8.0; t += 0.1) {
    EXPECT_NEAR(force(t).norm(), 0.2, 1e-15);
    EXPECT_EQ(force(t).x(), 0.0);
  }
  EXPECT_LT((force(2.0) - Vector3d(0.0, 0.2, 0.0)).norm(), 1e-15);
}

}  // namespace
}  // namespace palpate
