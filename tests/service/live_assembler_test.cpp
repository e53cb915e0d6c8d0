// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/service/live_assembler.hpp>

namespace palpate::service {
namespace {

using Status = SensorReading::Status;
constexpr std::int64_t kHold = 10'000'000;

SensorReading seen(double x = 0.0) {
  SensorReading out;
  out.status = Status::kOk;
  out.position_m.x() = x;
  return out;
}

TEST(LiveAssembler, AFrameIsClosedByItsLastSensor) {
  LiveAssembler frames(2, kHold);
  EXPECT_EQ(frames.close_before(1.0), nullptr);
  EXPECT_EQ(frames.put(0, 1.0, seen(0.1), 5), nullptr);
  const TrackerFrame* const frame = frames.put(1, 1.0, seen(0.2), 6);
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(frame->time_s, 1.0);
  EXPECT_EQ(frame->readings[0].position_m.x(), 0.1);
  EXPECT_EQ(frame->readings[1].position_m.x(), 0.2);
  EXPECT_EQ(frames.opened_ns(), 5);
  EXPECT_FALSE(frames.open());
}

TEST(LiveAssembler, ASensorThatFallsSilentIsWaitedForOnce) {
  LiveAssembler frames(2, kHold);
  frames.put(0, 1.0, seen(), 0);
  EXPECT_EQ(frames.close_overdue(kHold - 1), nullptr);
  const TrackerFrame* frame = frames.close_overdue(kHold);
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(frame->readings[1].status, Status::kMissing);
  frame = frames.put(0, 2.0, seen(), 0);  // now at once
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(frame->readings[1].status, Status::kMissing);
}

TEST(LiveAssembler, ASensorThatComesBackIsLateOnceThenWaitedFor) {
  LiveAssembler frames(2, kHold);
  frames.put(0, 1.0, seen(), 0);
  frames.close_overdue(kHold);
  frames.put(0, 2.0, seen(), 0);
  EXPECT_EQ(frames.put(1, 2.0, seen(), 0), nullptr);
  EXPECT_EQ(frames.late_readings(), 1u);
  EXPECT_EQ(frames.put(0, 3.0, seen(), 0), nullptr);
  const TrackerFrame* const frame = frames.put(1, 3.0, seen(), 0);
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(frame->readings[1].status, Status::kOk);
}

TEST(LiveAssembler, AnotherTimeClosesTheFrame) {
  LiveAssembler frames(2, kHold);
  frames.put(0, 1.0, seen(0.1), 0);
  const TrackerFrame* const frame = frames.close_before(2.0);
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(frame->time_s, 1.0);
  EXPECT_EQ(frames.close_before(2.0), nullptr);
}

TEST(LiveAssembler, TheFirstOfTwoReadingsCounts) {
  LiveAssembler frames(2, kHold);
  frames.put(0, 1.0, seen(0.1), 0);
  frames.put(0, 1.0, seen(0.9), 0);
  EXPECT_EQ(frames.put(1, 1.0, seen(), 0)->readings[0].position_m.x(), 0.1);
}

TEST(LiveAssembler, FramesAreNumbered) {
  LiveAssembler frames(1, kHold);
  EXPECT_EQ(frames.put(0, 1.0, seen(), 0)->number, 0);
  EXPECT_EQ(frames.put(0, 2.0, seen(), 0)->number, 1);
}

}  // namespace
}  // namespace palpate::service
