// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/observer/force_observer.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <palpate_ros2/frame_assembler.hpp>
#include <tests/ros2/look_alikes.hpp>

namespace palpate {
namespace {

using palpate_ros2::FrameAssembler;
using Frames = std::vector<FrameAssembler::Frame>;
constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

test::ros::PoseStamped pose(std::int64_t after_ms, double x_m = 0.0) {
  test::ros::PoseStamped message;
  message.header.stamp = palpate_ros2::to_stamp<test::ros::Time>(kStart_ns + 1'000'000 * after_ms);
  message.pose.position.x = x_m;
  return message;
}

bool is_missing(const FrameAssembler::Frame& frame, std::size_t sensor) {
  return frame.frame.readings.at(sensor).status == SensorReading::Status::kMissing;
}

TEST(Ros2Frames, OfOneStamp) {
  FrameAssembler assembler(2);
  EXPECT_TRUE(assembler.add(1, pose(0, 0.2)).empty());
  const Frames first = assembler.add(0, pose(0, 0.1));
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0].stamp_ns, kStart_ns);
  EXPECT_EQ(first[0].frame.time_s, 0.0);
  EXPECT_EQ(first[0].frame.readings[0].position_m.x(), 0.1);
  EXPECT_EQ(first[0].frame.readings[1].position_m.x(), 0.2);
  assembler.add(0, pose(25));
  const Frames second = assembler.add(1, pose(25));
  ASSERT_EQ(second.size(), 1u);
  EXPECT_DOUBLE_EQ(second[0].frame.time_s, 0.025);
  EXPECT_GT(second[0].frame.number, first[0].frame.number);
}

TEST(Ros2Frames, ASilentSensorIsMissing) {
  FrameAssembler assembler(2);
  EXPECT_TRUE(assembler.add(0, pose(0)).empty());
  EXPECT_TRUE(assembler.add(0, pose(25)).empty());
  const Frames frames = assembler.add(0, pose(50));
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_FALSE(is_missing(frames[0], 0));
  EXPECT_TRUE(is_missing(frames[0], 1));
}

TEST(Ros2Frames, AWholeFramePushesOutOlderOnes) {
  FrameAssembler assembler(2);
  assembler.add(0, pose(0));
  assembler.add(0, pose(25));
  const Frames frames = assembler.add(1, pose(25));
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_TRUE(is_missing(frames[0], 1));
  EXPECT_FALSE(is_missing(frames[1], 1));
  EXPECT_TRUE(assembler.add(1, pose(0)).empty());  // its frame is gone
  EXPECT_EQ(assembler.late(), 1);
}

TEST(Ros2Frames, SensorsThatRunBehindStillMeet) {
  FrameAssembler assembler(2);
  std::size_t whole = 0;
  for (int i = 0; i < 20; ++i) {
    assembler.add(0, pose(25 * (i + 1)));
    for (const FrameAssembler::Frame& frame : assembler.add(1, pose(25 * i))) whole += !is_missing(frame, 0);
  }
  EXPECT_EQ(whole, 19u);
}

TEST(Ros2Frames, ABagPlayedAgainIsANewStart) {
  FrameAssembler assembler(2);
  for (int i = 0; i < 100; ++i) assembler.add(0, pose(25 * i)), assembler.add(1, pose(25 * i));
  std::size_t whole = 0;
  for (int i = 0; i < 10; ++i) {
    assembler.add(0, pose(25 * i));
    for (const FrameAssembler::Frame& frame : assembler.add(1, pose(25 * i))) whole += !is_missing(frame, 0);
  }
  EXPECT_EQ(whole, 10u);
  EXPECT_EQ(assembler.late(), 0);
}

/// The whole way: poses of a virtual catheter as messages, and the force that comes back.
TEST(Ros2Frames, MessagesGiveTheSameForceAsFrames) {
  Catheter catheter;
  catheter.rod = uniform_rod(0.07, {2.6e-4, 1.7e-4, 1.6e-4}, {20.0, 0.0, 0.0});
  for (const double arc_length_m : {0.07, 0.065}) {
    catheter.sensors.emplace_back();
    catheter.sensors.back().name = arc_length_m == 0.07 ? "tip" : "shaft";
    catheter.sensors.back().arc_length_m = arc_length_m;
  }
  const auto recording =
      simulate_tracker(catheter, [](double) { return Vector3d(0.02, -0.03, -0.06); }, {.duration_s = 1.0});
  ForceObserver by_frames(catheter, {}), by_messages(catheter, {});
  FrameAssembler assembler(2);
  Estimate expected, found;
  for (std::size_t k = 0; k < recording.frames.size(); ++k) {
    expected = by_frames.update(recording.frames[k]);
    for (std::size_t i = 0; i < 2; ++i) {
      const SensorReading& reading = recording.frames[k].readings[i];
      test::ros::PoseStamped message = pose(25 * static_cast<std::int64_t>(k));
      message.pose.position = {reading.position_m.x(), reading.position_m.y(), reading.position_m.z()};
      const Eigen::Vector4d& q = reading.quaternion_wxyz;
      message.pose.orientation = {.x = q[1], .y = q[2], .z = q[3], .w = q[0]};
      for (const FrameAssembler::Frame& ready : assembler.add(i, message)) found = by_messages.update(ready.frame);
    }
  }
  EXPECT_EQ(found.status, expected.status);
  EXPECT_LT((found.force_tip_N - expected.force_tip_N).norm(), 1e-9);
  EXPECT_TRUE(palpate_ros2::is_measured(found));
}

}  // namespace
}  // namespace palpate
