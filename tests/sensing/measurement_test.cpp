// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/sensing/measurement.hpp>
#include <tests/sensing/virtual_setups.hpp>

namespace palpate {
namespace {

using test::Draws;

/// Composition through 4 x 4 matrices: independent of Pose's own products.
Eigen::Matrix4d homogeneous(const Pose& T) {
  Eigen::Matrix4d M = Eigen::Matrix4d::Identity();
  M.topLeftCorner<3, 3>() = T.R;
  M.topRightCorner<3, 1>() = T.p;
  return M;
}

double distance(const Pose& T, const Eigen::Matrix4d& M) { return (homogeneous(T) - M).norm(); }

TEST(RegisterFrame, FixedBaseGivesThePosesInTheBaseFrame) {
  const Catheter catheter = test::two_sensors();
  Draws draws(1);
  const Pose tip = draws.pose(0.2), shaft = draws.pose(0.2);
  TrackerFrame frame{.readings = {test::reading_of(tip), test::reading_of(shaft)}};
  Measurement m;
  register_frame(catheter, frame, m);
  ASSERT_EQ(m.count, 2);
  const Eigen::Matrix4d to_base = homogeneous(catheter.base.T_tracker_base).inverse();
  EXPECT_EQ(m.poses[0].sensor, 0);
  EXPECT_EQ(m.poses[1].sensor, 1);
  EXPECT_LT(distance(m.poses[0].T_base_sensor, to_base * homogeneous(tip)), 1e-14);
  EXPECT_LT(distance(m.poses[1].T_base_sensor, to_base * homogeneous(shaft)), 1e-14);
}

TEST(RegisterFrame, TrackedBaseIsFoundThroughItsMounting) {
  Catheter catheter = test::with_tracked_base(test::two_sensors());
  Draws draws(2);
  const Pose base_sensor = draws.pose(0.2), tip = draws.pose(0.2), shaft = draws.pose(0.2);
  catheter.base.T_tracker_base = draws.pose(5.0);  // must not matter
  TrackerFrame frame{.readings = {test::reading_of(tip), test::reading_of(shaft), test::reading_of(base_sensor)}};
  Measurement m;
  register_frame(catheter, frame, m);
  ASSERT_EQ(m.count, 2);
  const Eigen::Matrix4d base = homogeneous(base_sensor) * homogeneous(catheter.base.sensor.T_local_sensor).inverse();
  EXPECT_LT(distance(m.poses[0].T_base_sensor, base.inverse() * homogeneous(tip)), 1e-14);
  EXPECT_LT(distance(m.poses[1].T_base_sensor, base.inverse() * homogeneous(shaft)), 1e-14);
}

TEST(RegisterFrame, LostBaseLeavesNothingButSaysWhichReadingsWereGood) {
  const Catheter catheter = test::with_tracked_base(test::two_sensors());
  TrackerFrame frame = test::exact_frame(catheter, Vector3d::Zero());
  frame.readings[2] = SensorReading{};
  frame.readings[1].position_m.x() = std::numeric_limits<double>::quiet_NaN();
  Measurement m;
  register_frame(catheter, frame, m);
  EXPECT_EQ(m.count, 0);
  EXPECT_EQ(m.rejections[0], Rejection::kNone);
  EXPECT_EQ(m.rejections[1], Rejection::kNotFinite);
  EXPECT_EQ(m.rejections[2], Rejection::kMissing);
}

TEST(RegisterFrame, ASensorWithARegistrationOfItsOwnUsesThat) {
  Draws draws(4);
  const Pose tip = draws.pose(0.2), shaft = draws.pose(0.2), base_sensor = draws.pose(0.2);
  for (const bool tracked : {false, true}) {
    Catheter catheter = test::two_sensors();
    if (tracked) catheter = test::with_tracked_base(catheter);
    catheter = test::with_second_tracker(catheter);
    TrackerFrame frame{.readings = {test::reading_of(tip), test::reading_of(shaft)}};
    if (tracked) frame.readings.push_back(test::reading_of(base_sensor));
    Measurement m;
    register_frame(catheter, frame, m);
    ASSERT_EQ(m.count, 2);
    const Eigen::Matrix4d base =
        tracked ? homogeneous(base_sensor) * homogeneous(catheter.base.sensor.T_local_sensor).inverse()
                : homogeneous(catheter.base.T_tracker_base);
    const Eigen::Matrix4d own = homogeneous(*catheter.sensors[1].T_tracker_base);
    EXPECT_LT(distance(m.poses[0].T_base_sensor, base.inverse() * homogeneous(tip)), 1e-14);
    EXPECT_LT(distance(m.poses[1].T_base_sensor, own.inverse() * homogeneous(shaft)), 1e-14);
  }
}

/// The base as an earlier frame had it is not used again; a sensor that does not need it goes on.
TEST(RegisterFrame, ABaseThatIsNotInTheFrameLeavesOutTheSensorsThatNeedIt) {
  const Catheter catheter = test::with_tracked_base(test::two_sensors()),
                 two_trackers = test::with_second_tracker(catheter);
  Measurement m;
  TrackerFrame frame = test::exact_frame(catheter, Vector3d::Zero());
  register_frame(catheter, frame, m);
  ASSERT_EQ(m.count, 2);
  frame.readings[2] = {.status = SensorReading::Status::kAbsent};
  register_frame(catheter, frame, m);
  EXPECT_EQ(m.count, 0);
  EXPECT_EQ(m.rejections[0], Rejection::kNone);
  EXPECT_EQ(m.rejections[2], Rejection::kAbsent);
  register_frame(two_trackers, frame, m);
  ASSERT_EQ(m.count, 1);
  EXPECT_EQ(m.poses[0].sensor, 1);
}

TEST(RegisterFrame, AbsentReadingsAreLeftOutUnderTheirOwnName) {
  const Catheter catheter = test::two_sensors();
  TrackerFrame frame = test::exact_frame(catheter, Vector3d::Zero());
  frame.readings[0] = {.status = SensorReading::Status::kAbsent};
  Measurement m;
  register_frame(catheter, frame, m);
  ASSERT_EQ(m.count, 1);
  EXPECT_EQ(m.poses[0].sensor, 1);
  EXPECT_EQ(m.rejections[0], Rejection::kAbsent);
}

TEST(RegisterFrame, BadReadingsAreLeftOutAndTheRestKeepsItsIndex) {
  const Catheter catheter = test::mixed_sensors();
  TrackerFrame frame = test::exact_frame(catheter, {0.01, 0.02, -0.05});
  frame.readings[0].quaternion_wxyz.setZero();
  Measurement m;
  register_frame(catheter, frame, m);
  ASSERT_EQ(m.count, 2);
  EXPECT_EQ(m.poses[0].sensor, 1);
  EXPECT_EQ(m.poses[1].sensor, 2);
  EXPECT_EQ(m.rejections[0], Rejection::kZeroQuaternion);
}

TEST(RegisterFrame, NothingOfAnEarlierFrameStays) {
  const Catheter catheter = test::two_sensors();
  Measurement m;
  TrackerFrame frame = test::exact_frame(catheter, Vector3d::Zero());
  frame.readings[1] = SensorReading{};
  register_frame(catheter, frame, m);
  register_frame(catheter, test::exact_frame(catheter, Vector3d::Zero()), m);
  EXPECT_EQ(m.count, 2);
  EXPECT_EQ(m.rejections[1], Rejection::kNone);
}

TEST(ReadingPose, BothSignsOfAQuaternionAndASlightlyLongOneAreTheSameRotation) {
  SensorReading reading = test::reading_of(test::some_pose());
  for (const double factor : {1.0, -1.0, 1.005}) {
    SensorReading scaled = reading;
    scaled.quaternion_wxyz *= factor;
    EXPECT_LT((reading_pose(scaled).R - test::some_pose().R).norm(), 1e-15 * 10);
  }
}

}  // namespace
}  // namespace palpate
