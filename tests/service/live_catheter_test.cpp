// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/service/board.hpp>
#include <palpate/service/live_catheter.hpp>
#include <tests/observer/allocation_counter.hpp>
#include <tests/service/demo_frames.hpp>

namespace palpate::service {
namespace {

using test::kMillisecond_ns;
constexpr std::int64_t kStart_ns = 1'800'000'000'000'000'000;
constexpr std::int64_t kStale_ns = 100 * kMillisecond_ns;

struct Watched {
  std::vector<TrackerFrame> frames = test::demo_frames();
  LiveCatheter catheter{
      3, test::demo_catheter().settings.catheter, test::demo_catheter().settings.observer, {kStale_ns, true}};
  session::LiveRecord record;
  std::int64_t now_ns = kStart_ns;

  void play(std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      now_ns += 25 * kMillisecond_ns;
      catheter.take(frames[i], now_ns, record);
    }
  }
};

TEST(LiveCatheter, EstimatesAsTheObserverAlone) {
  Watched watched;
  ForceObserver alone(test::demo_catheter().settings.catheter, test::demo_catheter().settings.observer);
  for (std::size_t i = 0; i < watched.frames.size(); ++i) {
    watched.play(i, i + 1);
    const Estimate expected = alone.update(watched.frames[i]);
    EXPECT_EQ(watched.record.estimate.force_tip_N, expected.force_tip_N);
    EXPECT_EQ(watched.record.estimate.covariance_tip_N2, expected.covariance_tip_N2);
  }
  EXPECT_EQ(watched.record.catheter, 3);
}

TEST(LiveCatheter, SilenceIsSaidOnceAndOver) {
  Watched watched;
  watched.play(0, 40);
  const Matrix3d before = watched.record.estimate.covariance_tip_N2;
  EXPECT_FALSE(watched.catheter.look(watched.now_ns + kStale_ns - 1, watched.record));
  EXPECT_EQ(watched.catheter.next_look_ns(), watched.now_ns + kStale_ns);
  ASSERT_TRUE(watched.catheter.look(watched.now_ns + kStale_ns, watched.record));
  EXPECT_EQ(watched.record.kind, session::LiveRecord::Kind::kStale);
  EXPECT_EQ(watched.record.estimate.status, EstimateStatus::kStale);
  EXPECT_GT(watched.record.estimate.covariance_tip_N2.trace(), before.trace());
  EXPECT_FALSE(watched.catheter.look(watched.now_ns + 2 * kStale_ns, watched.record));
  watched.now_ns += 3 * kStale_ns;
  watched.play(41, 42);
  ASSERT_EQ(watched.catheter.changes().size(), 1u);
  EXPECT_STREQ(watched.catheter.changes()[0], "live");
  EXPECT_EQ(watched.catheter.counters().stale.get(), 1u);
}

TEST(LiveCatheter, ADeviceThatRepeatsItsLastFrameGoesStale) {
  Watched watched;
  watched.play(0, 40);
  for (int i = 0; i < 8; ++i)
    watched.catheter.take(watched.frames[39], watched.now_ns += 25 * kMillisecond_ns, watched.record);
  EXPECT_TRUE(watched.catheter.look(watched.now_ns, watched.record));
}

TEST(LiveCatheter, AShiftedSensorIsSaidWithinTenFrames) {
  Watched watched;
  watched.play(0, 40);
  for (TrackerFrame& frame : watched.frames)
    for (SensorReading& reading : frame.readings) reading.position_m += Vector3d(5e-3, 0.0, -3e-3);
  int frames = 0;
  for (std::size_t i = 40; i < 50 && watched.catheter.counters().inconsistent.get() == 0; ++i, ++frames)
    watched.play(i, i + 1);
  EXPECT_EQ(watched.catheter.counters().inconsistent.get(), 1u) << frames;
}

TEST(LiveCatheter, CountsEveryFrameAndReading) {
  Watched watched;
  watched.frames[10].readings[1] = {};                                                      // missing
  watched.frames[11].readings[0].quaternion_wxyz.setZero();                                 // broken
  watched.frames[12].time_s = watched.frames[11].time_s;                                    // a duplicate
  watched.frames[13].readings[0].position_m.x() = std::numeric_limits<double>::infinity();  // not finite
  watched.play(0, 80);
  const CatheterCounters& counters = watched.catheter.counters();
  const auto count = [&](std::size_t sensor, Rejection reason) {
    return counters.by_sensor_and_reason[sensor][static_cast<std::size_t>(reason)].get();
  };
  EXPECT_EQ(counters.frames.get(), 80u);
  EXPECT_EQ(count(1, Rejection::kMissing), 1u);
  EXPECT_EQ(count(0, Rejection::kZeroQuaternion), 1u);
  EXPECT_EQ(count(0, Rejection::kNotFinite), 1u);
  EXPECT_EQ(counters.by_time[static_cast<std::size_t>(FrameTime::kStandsStill)].get(), 1u);
  EXPECT_EQ(count(0, Rejection::kNone), 77u);
  EXPECT_EQ(count(1, Rejection::kNone), 78u);
}

TEST(LiveCatheter, AFrameThatWaitedOnItsWayIsOld) {
  Watched watched;
  watched.play(0, 40);
  EXPECT_LT(watched.record.late_s, 1e-4);
  watched.now_ns += 500 * kMillisecond_ns;
  watched.play(40, 41);
  EXPECT_NEAR(watched.record.late_s, 0.5, 1e-3);

  CatheterView view;
  view.settings = &test::demo_catheter();
  view.live = &watched.catheter;
  ASSERT_TRUE(view.take(watched.record));
  const Health health = health_of(view, watched.now_ns);
  EXPECT_EQ(health.state, LiveState::kStale);
  ASSERT_EQ(health.words.size(), 1u);
  EXPECT_EQ(health.words[0], "no usable frame for 0.5 s");
}

TEST(LiveCatheter, AllocatesNothing) {
  Watched watched;
  watched.play(0, 2);
  const test::CountAllocations allocations;
  watched.play(2, 80);
  watched.catheter.look(watched.now_ns + kStale_ns, watched.record);
  EXPECT_EQ(allocations.so_far(), 0u);
}

}  // namespace
}  // namespace palpate::service
