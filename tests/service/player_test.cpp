// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <palpate/service/player.hpp>
#include <thread>

namespace palpate::service {
namespace {

std::vector<TrackerFrame> frames_at(const std::vector<double>& times_s) {
  std::vector<TrackerFrame> out;
  for (const double time_s : times_s)
    out.push_back({.time_s = time_s, .number = static_cast<std::int64_t>(out.size())});
  return out;
}

struct Played {
  double time_s, after_s;
};

/// Everything that comes out of the queue until the reels have ended, or `most` frames.
std::vector<Played> play(std::vector<Reel> reels, std::size_t most = 1'000'000) {
  HostClock clock;
  Wakeup wakeup;
  FrameQueue queue(wakeup, 0);
  Player player(clock, queue, std::move(reels));
  const std::int64_t start_ns = clock.now_ns();
  std::atomic<bool> done{false};
  std::thread thread([&] {
    player.run();
    done = true;
  });
  std::vector<Played> out;
  while (out.size() < most) {
    const bool last = done;
    if (const ArrivedFrame* const frame = queue.front()) {
      out.push_back({frame->frame.time_s, kSecondsPerNanosecond * static_cast<double>(frame->received_ns - start_ns)});
      queue.pop();
    } else if (last) {
      break;
    } else {
      wakeup.wait(1'000'000);
    }
  }
  player.stop();
  thread.join();
  return out;
}

TEST(Player, KeepsTheTimeOfTheFrames) {
  CatheterCounters counters;
  const std::vector<Played> out = play({{.frames = frames_at({7.0, 7.02, 7.04, 7.1}), .counters = &counters}});
  ASSERT_EQ(out.size(), 4u);
  EXPECT_EQ(out[3].time_s, 7.1);
  EXPECT_GE(out[3].after_s, 0.1);
  EXPECT_GE(out[2].after_s, 0.04);
}

TEST(Player, ASpeedShortensIt) {
  CatheterCounters counters;
  const std::vector<Played> out = play({{.frames = frames_at({0.0, 1000.0}), .speed = 1000.0, .counters = &counters}});
  ASSERT_EQ(out.size(), 2u);
  EXPECT_GE(out[1].after_s, 1.0);
  EXPECT_LT(out[1].after_s, 100.0);
}

TEST(Player, AsFastAsItGoesDropsNothing) {
  CatheterCounters counters;
  std::vector<double> times_s;
  for (int i = 0; i < 20'000; ++i) times_s.push_back(i);
  const std::vector<Played> out = play({{.frames = frames_at(times_s), .speed = 0.0, .counters = &counters}});
  ASSERT_EQ(out.size(), times_s.size());
  EXPECT_EQ(out.back().time_s, 19'999.0);
  EXPECT_EQ(counters.queue_dropped.get(), 0u);
}

TEST(Player, TimeThatDoesNotRunOnCostsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CatheterCounters counters;
  const std::vector<Played> out = play({{.frames = frames_at({5.0, 5.0, 4.0, nan, 5.01}), .counters = &counters}});
  ASSERT_EQ(out.size(), 5u);
  EXPECT_LT(out[4].after_s, 100.0);
}

TEST(Player, AReelThatBeginsAgainGoesOnInTime) {
  CatheterCounters counters;
  const std::vector<Played> out =
      play({{.frames = frames_at({1.0, 1.001, 1.002}), .loop = true, .counters = &counters}}, 9);
  ASSERT_EQ(out.size(), 9u);
  for (std::size_t i = 1; i < out.size(); ++i) EXPECT_NEAR(out[i].time_s - out[i - 1].time_s, 0.001, 1e-9);
}

TEST(Player, SeveralReelsAreInterleaved) {
  CatheterCounters counters;
  const std::vector<Played> out =
      play({{.catheter = 0, .frames = frames_at({0.0, 0.02}), .counters = &counters},
            {.catheter = 1, .frames = frames_at({10.0, 10.01, 10.03}), .counters = &counters}});
  std::vector<double> times_s;
  for (const Played& each : out) times_s.push_back(each.time_s);
  EXPECT_EQ(times_s, (std::vector<double>{0.0, 10.0, 10.01, 0.02, 10.03}));
}

}  // namespace
}  // namespace palpate::service
