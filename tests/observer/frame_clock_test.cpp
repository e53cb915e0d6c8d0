// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <palpate/observer/frame_clock.hpp>

namespace palpate {
namespace {

void expect(const FrameClock::Step& step, FrameTime verdict, double dt_s) {
  EXPECT_EQ(step.verdict, verdict);
  EXPECT_NEAR(step.dt_s, dt_s, 1e-12);
  const bool accepted =
      verdict == FrameTime::kFirst || verdict == FrameTime::kAdvanced || verdict == FrameTime::kResynchronised;
  EXPECT_EQ(step.accepted(), accepted);
  if (!accepted) {
    EXPECT_EQ(step.dt_s, 0.0);
  }
}

TEST(FrameClock, FirstFrameTakesNoTimeWhateverItsStamp) {
  for (const double time_s : {0.0, -5.0, 1.7e9}) {
    FrameClock clock;
    expect(clock.advance(time_s), FrameTime::kFirst, 0.0);
  }
}

TEST(FrameClock, LaterFramesAdvanceByTheDifference) {
  FrameClock clock;
  clock.advance(10.0);
  expect(clock.advance(10.025), FrameTime::kAdvanced, 0.025);
  expect(clock.advance(10.125), FrameTime::kAdvanced, 0.1);
}

TEST(FrameClock, AVeryLongGapIsClamped) {
  FrameClock clock;
  clock.advance(0.0);
  expect(clock.advance(7200.0), FrameTime::kAdvanced, FrameClock::kLongestStep_s);
  expect(clock.advance(7200.5), FrameTime::kAdvanced, 0.5);
}

TEST(FrameClock, SameTimeStandsStillAndDoesNotDisturbTheNextStep) {
  FrameClock clock;
  clock.advance(1.0);
  for (int i = 0; i < 20; ++i) expect(clock.advance(1.0), FrameTime::kStandsStill, 0.0);
  expect(clock.advance(1.5), FrameTime::kAdvanced, 0.5);
}

TEST(FrameClock, NotANumberIsRefusedEvenAsTheFirst) {
  FrameClock clock;
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()})
    expect(clock.advance(bad), FrameTime::kNotFinite, 0.0);
  expect(clock.advance(1.0), FrameTime::kFirst, 0.0);
  expect(clock.advance(std::numeric_limits<double>::quiet_NaN()), FrameTime::kNotFinite, 0.0);
  expect(clock.advance(1.25), FrameTime::kAdvanced, 0.25);
}

TEST(FrameClock, AFrameOutOfOrderIsRefusedAndTimeRunsOn) {
  FrameClock clock;
  clock.advance(1.0);
  clock.advance(1.1);
  expect(clock.advance(1.05), FrameTime::kStepsBack, 0.0);
  expect(clock.advance(1.2), FrameTime::kAdvanced, 0.1);
}

TEST(FrameClock, AClockSetBackThatRunsOnIsAcceptedAfterFiveFrames) {
  FrameClock clock;
  clock.advance(100.0);
  for (int i = 0; i < FrameClock::kFramesToResynchronise; ++i)
    expect(clock.advance(10.0 + 0.1 * i), FrameTime::kStepsBack, 0.0);
  expect(clock.advance(10.5), FrameTime::kResynchronised, 0.5);
  expect(clock.advance(10.6), FrameTime::kAdvanced, 0.1);
}

TEST(FrameClock, FiveStrayFramesThatDoNotRunOnAreNoNewClock) {
  FrameClock clock;
  clock.advance(100.0);
  for (int i = 0; i < 50; ++i) expect(clock.advance(10.0 - i), FrameTime::kStepsBack, 0.0);
  expect(clock.advance(100.5), FrameTime::kAdvanced, 0.5);
}

TEST(FrameClock, AGoodFrameBetweenEndsTheRun) {
  FrameClock clock;
  clock.advance(100.0);
  for (int round = 0; round < 10; ++round) {
    for (int i = 0; i < FrameClock::kFramesToResynchronise; ++i)
      expect(clock.advance(10.0 + round + 0.1 * i), FrameTime::kStepsBack, 0.0);
    expect(clock.advance(100.1 + 0.1 * round), FrameTime::kAdvanced, 0.1);
  }
}

TEST(FrameClock, ResynchronisingStepIsClampedToo) {
  FrameClock clock;
  clock.advance(1e6);
  for (int i = 0; i < FrameClock::kFramesToResynchronise; ++i) clock.advance(10.0 * i);
  expect(clock.advance(5e5), FrameTime::kResynchronised, FrameClock::kLongestStep_s);
}

}  // namespace
}  // namespace palpate
