// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <palpate_ros2/mapping.hpp>
#include <tests/ros2/look_alikes.hpp>

namespace palpate {
namespace {

using namespace palpate_ros2;
using test::ros::DiagnosticStatus;
using test::ros::ForceWithCovarianceStamped;
using test::ros::Time;
using test::ros::Wrench;

static_assert(PoseStamped<test::ros::PoseStamped>);
static_assert(!PoseStamped<Wrench>);

constexpr std::array kMeasured{EstimateStatus::kUpdated, EstimateStatus::kReseeded, EstimateStatus::kAmbiguous};
constexpr std::array kUnmeasured{EstimateStatus::kRejected, EstimateStatus::kHeld, EstimateStatus::kNotConverged,
                                 EstimateStatus::kStale};
static_assert(kMeasured.size() + kUnmeasured.size() == kEstimateStatuses);

/// A force that looks good; only the status tells whether it is.
Estimate estimate_of(EstimateStatus status) {
  Estimate estimate;
  estimate.status = status;
  estimate.force_tip_N = {0.01, -0.02, 0.03};
  estimate.covariance_tip_N2 << 1.0, 0.1, 0.2, 0.3, 2.0, 0.4, 0.5, 0.6, 3.0;  // not symmetric: the order shows
  estimate.sensors_used = 2;
  return estimate;
}

bool all_nan(const test::ros::Vector3& v) { return std::isnan(v.x) && std::isnan(v.y) && std::isnan(v.z); }

TEST(Ros2Mapping, Reading) {
  test::ros::PoseStamped message;
  message.pose.position = {0.1, 0.2, 0.3};
  message.pose.orientation = {.x = 0.5, .y = -0.5, .z = 0.1, .w = 0.7};
  const SensorReading reading = to_reading(message);
  EXPECT_EQ(reading.status, SensorReading::Status::kOk);
  EXPECT_TRUE(reading.has_orientation);
  EXPECT_EQ(reading.quaternion_wxyz, Eigen::Vector4d(0.7, 0.5, -0.5, 0.1));
  EXPECT_EQ(reading.position_m, Vector3d(0.1, 0.2, 0.3));
}

TEST(Ros2Mapping, StampsKeepEveryNanosecond) {
  const Time stamp{.sec = 2'000'000'000, .nanosec = 999'999'999};
  EXPECT_EQ(nanoseconds(stamp), 2'000'000'000'999'999'999);
  const Time again = to_stamp<Time>(nanoseconds(stamp));
  EXPECT_EQ(again.sec, stamp.sec);
  EXPECT_EQ(again.nanosec, stamp.nanosec);
}

TEST(Ros2Mapping, MeasuredForces) {
  for (const EstimateStatus status : kMeasured) {
    Wrench wrench;
    ForceWithCovarianceStamped force;
    set_wrench(estimate_of(status), wrench);
    set_force(estimate_of(status), force);
    for (const auto& v : {wrench.force, force.force}) EXPECT_EQ(Vector3d(v.x, v.y, v.z), Vector3d(0.01, -0.02, 0.03));
    EXPECT_EQ(wrench.torque.x, 0.0);
    EXPECT_THAT(force.covariance, testing::ElementsAre(1.0, 0.1, 0.2, 0.3, 2.0, 0.4, 0.5, 0.6, 3.0));
  }
}

TEST(Ros2Mapping, OldForcesAreNoForces) {
  for (const EstimateStatus status : kUnmeasured) {
    Wrench wrench;
    ForceWithCovarianceStamped force;
    set_wrench(estimate_of(status), wrench);
    set_force(estimate_of(status), force);
    EXPECT_TRUE(all_nan(wrench.force) && all_nan(wrench.torque) && all_nan(force.force)) << describe(status);
    for (const double variance : force.covariance) EXPECT_TRUE(std::isnan(variance));
  }
}

TEST(Ros2Mapping, AForceWithoutACovarianceIsNone) {
  Estimate estimate = estimate_of(EstimateStatus::kUpdated);
  estimate.covariance_tip_N2(1, 2) = std::nan("");
  Wrench wrench;
  set_wrench(estimate, wrench);
  EXPECT_TRUE(all_nan(wrench.force));
  EXPECT_EQ(level_of(estimate), Level::kError);
}

TEST(Ros2Mapping, Levels) {
  EXPECT_EQ(level_of(estimate_of(EstimateStatus::kUpdated)), Level::kOk);
  EXPECT_EQ(level_of(estimate_of(EstimateStatus::kReseeded)), Level::kOk);
  EXPECT_EQ(level_of(estimate_of(EstimateStatus::kAmbiguous)), Level::kWarn);
  for (const EstimateStatus status : {EstimateStatus::kRejected, EstimateStatus::kHeld, EstimateStatus::kNotConverged})
    EXPECT_EQ(level_of(estimate_of(status)), Level::kError);
  EXPECT_EQ(level_of(stale_estimate()), Level::kStale);
  EXPECT_FALSE(is_measured(stale_estimate()));
}

TEST(Ros2Mapping, Diagnostics) {
  DiagnosticStatus status;
  status.values.resize(3);  // of an older message
  set_diagnostics(estimate_of(EstimateStatus::kHeld), "catheter 7", 4, status);
  EXPECT_EQ(status.level, 2);
  EXPECT_EQ(status.message, "HELD");
  EXPECT_EQ(status.hardware_id, "catheter 7");
  ASSERT_EQ(status.values.size(), 4u);
  EXPECT_EQ(status.values[0].value, "2");
  EXPECT_EQ(status.values[3].value, "4");
}

}  // namespace
}  // namespace palpate
