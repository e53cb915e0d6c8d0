// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/math/units.hpp>
#include <palpate/simulation/error_tracker.hpp>

namespace palpate {
namespace {

using Status = SensorReading::Status;

constexpr double kNone = 1e-15;  // a catheter must have some noise

Catheter catheter_with(std::vector<Sensor> sensors) {
  Catheter catheter;
  catheter.rod = uniform_rod(0.07, {2.6e-4, 1.7e-4, 1.6e-4}, Vector3d::Zero());
  catheter.sensors = std::move(sensors);
  catheter.base.T_tracker_base = {exp_so3({0.3, -1.1, 0.5}), {0.1, -0.2, 0.3}};
  return catheter;
}

Sensor sensor(SensorKind kind = SensorKind::kPose, double noise_m = kNone, double noise_rad = kNone) {
  Sensor tip;
  tip.name = "tip";
  tip.kind = kind;
  tip.arc_length_m = 0.07;
  tip.noise_m = Vector3d::Constant(noise_m);
  tip.noise_rad = noise_rad;
  return tip;
}

Matrix3d rotation_of(const SensorReading& reading) {
  const auto& q = reading.quaternion_wxyz;
  return Eigen::Quaterniond(q(0), q(1), q(2), q(3)).normalized().toRotationMatrix();
}

const Pose kBent{exp_so3({0.7, 0.4, -0.2}), {0.01, 0.02, 0.06}};

SensorReading read_once(const Sensor& sensor, const TrackerErrors& errors, std::uint64_t seed,
                        const Pose& T_base_local = kBent) {
  const Catheter catheter = catheter_with({sensor});
  return ErrorTracker(catheter, errors, seed).read(std::array{T_base_local}, catheter.base.T_tracker_base)[0];
}

/// 500 fields, each a draw of a Gaussian: a mean square scatters by sqrt(2 / 3 / 500) = 4 %, a correlation by
/// 1 / sqrt(1500) = 0.026.
TEST(BiasField, HasItsSizeItsLengthAndNoPreferredAxis) {
  constexpr double kRms = 0.48e-3, kLength_m = 0.05;
  const Vector3d a(0.1, -0.2, 0.3), b = a + kLength_m * Vector3d(0.6, 0.0, 0.8), c = a + 0.2 * Vector3d::UnitY();
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  double near = 0.0, far = 0.0;
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const BiasField field(kRms, kLength_m, seed);
    const Vector3d at_a = field.at(a) / kRms;
    square += at_a * at_a.transpose() / 500.0;
    near += at_a.dot(field.at(b)) / kRms / 500.0;
    far += at_a.dot(field.at(c)) / kRms / 500.0;
  }
  EXPECT_NEAR(square.trace(), 1.0, 0.12);
  EXPECT_LT((square - Matrix3d::Identity() / 3.0).cwiseAbs().maxCoeff(), 0.08);
  EXPECT_NEAR(near, std::exp(-0.5), 0.08);
  EXPECT_NEAR(far, 0.0, 0.08) << "exp(-8)";
  EXPECT_EQ(BiasField(0.0, kLength_m, 1).at(a), Vector3d::Zero());
}

TEST(ErrorTracker, WithoutErrorsItTellsThePose) {
  Sensor mounted = sensor();
  mounted.T_local_sensor = {exp_so3({0.0, 0.2, 1.0}), {0.001, 0.0, -0.002}};
  const Pose T = catheter_with({mounted}).base.T_tracker_base * kBent * mounted.T_local_sensor;
  const SensorReading reading = read_once(mounted, {}, 1);
  EXPECT_EQ(reading.status, Status::kOk);
  EXPECT_LT((reading.position_m - T.p).norm(), 1e-13);
  EXPECT_LT((rotation_of(reading) - T.R).norm(), 1e-13);
}

/// 20 000 draws: a variance scatters by 1 %.
TEST(ErrorTracker, NoiseIsAlongTheBaseAxesAndTheSensorAxes) {
  Sensor noisy = sensor(SensorKind::kPose, kNone, 3e-3);
  noisy.noise_m = {1e-4, 2e-4, 4e-4};
  const Catheter catheter = catheter_with({noisy});
  const Pose T = catheter.base.T_tracker_base * kBent;
  ErrorTracker tracker(catheter, {}, 5);
  Matrix3d position = Matrix3d::Zero(), rotation = Matrix3d::Zero();
  for (int i = 0; i < 20000; ++i) {
    const SensorReading reading = tracker.read(std::array{kBent}, catheter.base.T_tracker_base)[0];
    const Vector3d p = catheter.base.T_tracker_base.R.transpose() * (reading.position_m - T.p);
    const Vector3d n = log_so3(T.R.transpose() * rotation_of(reading));
    position += p * p.transpose() / 20000.0;
    rotation += n * n.transpose() / 20000.0;
  }
  EXPECT_LT((position - Vector3d(1e-8, 4e-8, 16e-8).asDiagonal().toDenseMatrix()).cwiseAbs().maxCoeff(), 0.6e-8);
  EXPECT_NEAR(position(0, 0), 1e-8, 0.04e-8);
  EXPECT_LT((rotation - 9e-6 * Matrix3d::Identity()).cwiseAbs().maxCoeff(), 0.4e-6);
}

/// An eighth of a correlation length apart, two sensors are wrong alike: what is left of the difference is
/// sqrt(2 (1 - exp(-1 / 128))) = 12 % of the error.
TEST(ErrorTracker, NeighboursShareTheirBias) {
  Catheter catheter = catheter_with({sensor(), sensor()});
  const TrackerErrors errors{.bias_m = 1e-3, .bias_rad = 5e-3, .bias_length_m = 0.04};
  const Pose behind{kBent.R, kBent.p - 0.005 * Vector3d::UnitZ()};
  double error_m = 0.0, difference_m = 0.0, error_rad = 0.0, difference_rad = 0.0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const auto readings =
        ErrorTracker(catheter, errors, seed).read(std::array{kBent, behind}, catheter.base.T_tracker_base);
    const Vector3d a = readings[0].position_m - catheter.base.T_tracker_base * kBent.p;
    const Vector3d b = readings[1].position_m - catheter.base.T_tracker_base * behind.p;
    const Matrix3d R = catheter.base.T_tracker_base.R * kBent.R;
    error_m += a.squaredNorm(), difference_m += (a - b).squaredNorm();
    error_rad += log_so3(rotation_of(readings[0]) * R.transpose()).squaredNorm();
    difference_rad += log_so3(rotation_of(readings[0]) * rotation_of(readings[1]).transpose()).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(error_m / 200.0), 1e-3, 0.12e-3);
  EXPECT_NEAR(std::sqrt(error_rad / 200.0), 5e-3, 0.6e-3);
  EXPECT_NEAR(std::sqrt(difference_m / error_m), 0.125, 0.03);
  EXPECT_NEAR(std::sqrt(difference_rad / error_rad), 0.125, 0.03);
}

/// However the catheter turns about the sensor's axis, a 5-DOF sensor says the same: the axis.
TEST(ErrorTracker, FiveDegreesOfFreedomTellNothingOfTheRoll) {
  const Sensor five = sensor(SensorKind::kPose5);
  const Matrix3d R = catheter_with({five}).base.T_tracker_base.R * kBent.R;
  const SensorReading first = read_once(five, {}, 3);
  EXPECT_LT((rotation_of(first).col(2) - R.col(2)).norm(), 1e-12);
  const Pose turned{kBent.R * exp_so3({0.0, 0.0, 1.3}), kBent.p};
  EXPECT_LT((rotation_of(read_once(five, {}, 3, turned)) - rotation_of(first)).norm(), 1e-12);
  EXPECT_GT((rotation_of(read_once(five, {}, 4)) - rotation_of(first)).norm(), 1e-3) << "a roll of each sensor's own";
  EXPECT_FALSE(read_once(sensor(SensorKind::kPosition), {}, 3).has_orientation);
}

TEST(ErrorTracker, RoundsToItsSteps) {
  const SensorReading r = read_once(sensor(), {.position_step_m = 1e-4, .quaternion_step = 0.01}, 1);
  const SensorReading exact = read_once(sensor(), {}, 1);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(r.position_m(i) / 1e-4, std::round(r.position_m(i) / 1e-4), 1e-9);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(r.quaternion_wxyz(i) * 100.0, std::round(r.quaternion_wxyz(i) * 100.0), 1e-9);
  EXPECT_LE((r.position_m - exact.position_m).cwiseAbs().maxCoeff(), 0.5e-4);
  EXPECT_GT((r.position_m - exact.position_m).norm(), 1e-6);
  const SensorReading coarse = read_once(sensor(), {.position_step_m = 10.0}, 1);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(std::signbit(coarse.position_m(i))) << "no negative zero";
}

TEST(ErrorTracker, StampsAreLateAndInOrder) {
  ErrorTracker late(catheter_with({sensor()}), {.latency_s = 0.1, .jitter_s = 1e-3}, 1);
  double mean = 0.0, square = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double late_s = late.stamp(0.025 * i) - 0.025 * i;
    mean += late_s / 4000.0;
    square += (late_s - 0.1) * (late_s - 0.1) / 4000.0;
  }
  EXPECT_NEAR(mean, 0.1, 1e-4);
  EXPECT_NEAR(std::sqrt(square), 1e-3, 5e-5);
  ErrorTracker wild(catheter_with({sensor()}), {.jitter_s = 0.1}, 1);
  for (double last = -1e9, i = 0.0; i < 1000.0; ++i) {
    const double stamp_s = wild.stamp(0.025 * i);
    EXPECT_GE(stamp_s, last + 0.99e-5);
    last = stamp_s;
  }
}

/// 4000 draws: a share of 0.2 scatters by 0.006.
TEST(ErrorTracker, FaultsHappenAsOftenAsAskedAndChangeNothingElse) {
  const Catheter catheter = catheter_with({sensor(SensorKind::kPose, 1e-4, 1e-3)});
  const Pose& base = catheter.base.T_tracker_base;
  ErrorTracker clean(catheter, {}, 9);
  ErrorTracker faulty(catheter, {.missing_share = 0.2, .dropped_share = 0.3, .outlier_share = 0.1}, 9);
  int missing = 0, astray = 0, dropped = 0;
  for (int i = 0; i < 4000; ++i) {
    const SensorReading good = clean.read(std::array{kBent}, base)[0], bad = faulty.read(std::array{kBent}, base)[0];
    dropped += faulty.drops_frame() ? 1 : 0;
    EXPECT_FALSE(clean.drops_frame());
    if (bad.status == Status::kMissing) {
      ++missing;
      continue;
    }
    EXPECT_EQ(bad.quaternion_wxyz, good.quaternion_wxyz);
    const double off_m = (bad.position_m - good.position_m).norm();
    if (off_m == 0.0) continue;
    ++astray;
    EXPECT_NEAR(off_m, 25e-3, 1e-12);
  }
  EXPECT_NEAR(missing / 4000.0, 0.2, 0.025);
  EXPECT_NEAR(dropped / 4000.0, 0.3, 0.03);
  EXPECT_NEAR(astray / static_cast<double>(4000 - missing), 0.1, 0.02);
}

TEST(ErrorTracker, EveryTrackerSeesTheClampMove) {
  Catheter catheter = catheter_with({sensor(), sensor()});
  catheter.sensors[1].name = "shaft";
  catheter.sensors[1].T_tracker_base = Pose{exp_so3({0.0, 2.0, 0.0}), {0.5, 0.0, 0.0}};
  catheter.base.tracked = true;
  catheter.base.sensor = sensor();
  catheter.base.sensor.T_local_sensor.p = {0.0, 0.01, 0.0};
  const Pose along{exp_so3({0.0, 0.0, 0.4}), {0.0, 0.0, 0.02}};
  const Pose now = catheter.base.T_tracker_base * along;
  const auto readings = ErrorTracker(catheter, {}, 1).read(std::array{kBent, kBent}, now);
  ASSERT_EQ(readings.size(), 3U);
  EXPECT_LT((readings[0].position_m - now * kBent.p).norm(), 1e-12);
  EXPECT_LT((readings[1].position_m - (*catheter.sensors[1].T_tracker_base * along) * kBent.p).norm(), 1e-12);
  EXPECT_LT((readings[2].position_m - now * Vector3d(0.0, 0.01, 0.0)).norm(), 1e-12);
}

TEST(ErrorTracker, SameSeedSameReadings) {
  const TrackerErrors errors{.bias_m = 1e-3, .bias_rad = 1e-3};
  const Sensor noisy = sensor(SensorKind::kPose, 1e-4, 1e-3);
  EXPECT_EQ(read_once(noisy, errors, 6).position_m, read_once(noisy, errors, 6).position_m);
  EXPECT_NE(read_once(noisy, errors, 6).position_m, read_once(noisy, errors, 7).position_m);
}

}  // namespace
}  // namespace palpate
