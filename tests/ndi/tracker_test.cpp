// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <palpate/ndi/tracker.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <random>
#include <tests/ndi/aurora_simulator.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/service/demo_frames.hpp>

namespace palpate::ndi {
namespace {

using namespace std::chrono_literals;
using Fault = test::AuroraSimulator::Fault;
using Script = test::AuroraSimulator::Script;
using Status = SensorReading::Status;

std::int64_t now_ns() { return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count(); }

TrackerOptions quick(const std::filesystem::path& port) {
  TrackerOptions options;
  options.device = {.path = port.string(), .setup_timeout_s = 0.15, .reply_timeout_s = 0.1, .break_s = 0.0};
  options.device.after_comm_s = 0.001;
  options.sensors = 2;
  options.least_poll_s = 0.0002;
  options.first_wait_s = 0.01;
  options.longest_wait_s = 0.05;
  return options;
}

/// A tracker on a thread of its own, and what it told.
class Running {
 public:
  explicit Running(TrackerOptions options)
      : tracker_(std::move(options), {now_ns,
                                      [this](const TrackerFrame& frame, std::int64_t) {
                                        const std::lock_guard lock(mutex_);
                                        frames_.push_back(frame);
                                        changed_.notify_all();
                                      },
                                      [this](bool connected, const std::string& why) {
                                        const std::lock_guard lock(mutex_);
                                        states_.push_back(connected ? "connected" : why);
                                        changed_.notify_all();
                                      }}),
        thread_([this] { tracker_.run(); }) {}
  ~Running() { stop(); }

  /// How long it took [s].
  double stop() {
    const std::int64_t begin = now_ns();
    tracker_.stop();
    if (thread_.joinable()) thread_.join();
    return 1e-9 * static_cast<double>(now_ns() - begin);
  }
  bool wait_for_frames(std::size_t count) {
    return wait([&] { return frames_.size() >= count; });
  }
  bool wait_for_states(std::size_t count) {
    return wait([&] { return states_.size() >= count; });
  }
  TrackerHealth health() const { return tracker_.health(); }
  std::vector<TrackerFrame> frames() const {
    const std::lock_guard lock(mutex_);
    return frames_;
  }
  std::vector<std::string> states() const {
    const std::lock_guard lock(mutex_);
    return states_;
  }

 private:
  template <typename Condition>
  bool wait(const Condition& condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, 5s, condition);
  }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<TrackerFrame> frames_;
  std::vector<std::string> states_;
  Tracker tracker_;
  std::thread thread_;
};

/// The demonstration's catheter before its beating wall, the first readings of which are lost now and then.
const std::vector<TrackerFrame>& catheter_frames() {
  static const std::vector<TrackerFrame> frames = [] {
    VirtualTrackerOptions options;
    options.duration_s = 1.0;
    options.missing_share = 0.1;
    return simulate_tracker(test::demo_catheter().settings.catheter, beating_wall_force, options).frames;
  }();
  return frames;
}

class NdiTracker : public test::TemporaryFolder {
 protected:
  static Script script(int questions_a_frame = 1) {
    return {.frames = catheter_frames(), .questions_a_frame = questions_a_frame};
  }
  std::filesystem::path port() const { return path("aurora"); }
};

void expect_same(const SensorReading& got, const SensorReading& sent, std::size_t sensor) {
  ASSERT_EQ(got.status, sent.status);
  if (sent.status != Status::kOk) return;
  EXPECT_TRUE(got.has_orientation);
  for (Eigen::Index k = 0; k < 4; ++k)
    EXPECT_EQ(got.quaternion_wxyz(k), static_cast<double>(static_cast<float>(sent.quaternion_wxyz(k))));
  for (Eigen::Index k = 0; k < 3; ++k)
    EXPECT_EQ(got.position_m(k), 1e-3 * static_cast<double>(static_cast<float>(1000.0 * sent.position_m(k))));
  EXPECT_EQ(got.error_m, 1e-3 * (0.25 + 0.5 * static_cast<double>(sensor)));
}

TEST_F(NdiTracker, EveryFrameArrivesOnceAndExactToTheFloat) {
  for (const int questions_a_frame : {1, 4}) {
    test::AuroraSimulator aurora(port(), script(questions_a_frame));
    Running running(quick(port()));
    const std::size_t count = catheter_frames().size();
    ASSERT_TRUE(running.wait_for_frames(count));
    std::this_thread::sleep_for(20ms);  // the last frame is told again and again: none of that may come
    EXPECT_LT(running.stop(), 0.2);
    const auto frames = running.frames();
    ASSERT_EQ(frames.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(frames[i].number, 0xFF0 + static_cast<std::int64_t>(i));
      for (std::size_t sensor = 0; sensor < 2; ++sensor)
        expect_same(frames[i].readings[sensor], catheter_frames()[i].readings[sensor], sensor);
      EXPECT_GT(frames[i].time_s, i > 0 ? frames[i - 1].time_s : 0.0);
    }
    EXPECT_EQ(running.states(), std::vector<std::string>{"connected"});
    const TrackerHealth health = running.health();
    EXPECT_EQ(health.frames, count);
    EXPECT_GE(health.repeats, count * static_cast<std::size_t>(questions_a_frame - 1));
    EXPECT_EQ(health.malformed + health.unanswered, 0u);
  }
}

TEST_F(NdiTracker, TheDeviceIsPreparedAndLeftInOrder) {
  test::AuroraSimulator aurora(port(), script());
  Running running(quick(port()));
  ASSERT_TRUE(running.wait_for_frames(3));
  running.stop();
  const std::vector<std::string> expected{
      "INIT:",   "COMM:50000",   "PHSR:00",      "PHSR:01",  "PHSR:02",  "PINIT:0A", "PHSR:02", "PINIT:0B",  "PHSR:02",
      "PHSR:00", "PHINF:0A0020", "PHINF:0B0020", "PENA:0AD", "PENA:0BD", "TSTART:",  "TSTOP:",  "COMM:00000"};
  EXPECT_EQ(aurora.commands(), expected);
}

TEST_F(NdiTracker, ToolsAreFoundByTheirNames) {
  for (const bool by_port : {false, true}) {
    test::AuroraSimulator aurora(port(), script());
    TrackerOptions options = quick(port());
    options.tools = {ToolName(PortLocation{1, 1}), ToolName(PortLocation{1, 0})};
    if (!by_port) options.tools = {ToolName(std::uint8_t{0x0B}), ToolName(std::uint8_t{0x0A})};
    Running running(options);
    ASSERT_TRUE(running.wait_for_frames(catheter_frames().size()));
    const auto frames = running.frames();
    for (std::size_t i = 0; i < frames.size(); ++i) {
      expect_same(frames[i].readings[0], catheter_frames()[i].readings[1], 1);
      expect_same(frames[i].readings[1], catheter_frames()[i].readings[0], 0);
    }
  }
}

TEST_F(NdiTracker, OutOfVolumeBehindAndUnpluggedAreNoPoses) {
  Script what = script();
  for (TrackerFrame& frame : what.frames)
    for (std::size_t i = 0; i < 2; ++i) frame.readings[i] = catheter_frames()[0].readings[i];
  ASSERT_EQ(what.frames[0].readings[1].status, Status::kOk);
  what.outside = {3, 4, 5};
  what.behind = {10};
  what.unplugged = {20, 21};
  test::AuroraSimulator aurora(port(), what);
  Running running(quick(port()));
  ASSERT_TRUE(running.wait_for_frames(what.frames.size()));
  const auto frames = running.frames();
  for (int i = 0; i < static_cast<int>(frames.size()); ++i) {
    const Status expected = what.outside.contains(i) || what.unplugged.contains(i) ? Status::kMissing
                            : what.behind.contains(i)                              ? Status::kAbsent
                                                                                   : Status::kOk;
    EXPECT_EQ(frames[static_cast<std::size_t>(i)].readings[1].status, expected) << i;
    EXPECT_EQ(frames[static_cast<std::size_t>(i)].readings[0].status, Status::kOk) << i;
  }
  EXPECT_EQ(running.health().out_of_volume, 3u);
}

TEST_F(NdiTracker, TheCounterMayWrap) {
  Script what = script();
  what.first_number = 0xFFFFFFF8;
  test::AuroraSimulator aurora(port(), what);
  Running running(quick(port()));
  ASSERT_TRUE(running.wait_for_frames(what.frames.size()));
  const auto frames = running.frames();
  for (std::size_t i = 1; i < frames.size(); ++i) EXPECT_EQ(frames[i].number, frames[i - 1].number + 1);
}

TEST_F(NdiTracker, FaultsOfTheLineCostNoConnection) {
  Script what = script(2);  // each frame is told twice: what one answer lost the next one brings
  what.faults = {{4, Fault::kDroppedByte},
                 {10, Fault::kFlippedBit},
                 {16, Fault::kRubbish},
                 {22, Fault::kSilent},
                 {28, Fault::kSplit}};
  test::AuroraSimulator aurora(port(), what);
  Running running(quick(port()));
  ASSERT_TRUE(running.wait_for_frames(what.frames.size()));
  const auto frames = running.frames();
  for (std::size_t i = 0; i < frames.size(); ++i) EXPECT_EQ(frames[i].number, 0xFF0 + static_cast<std::int64_t>(i));
  const TrackerHealth health = running.health();
  EXPECT_EQ(health.connections, 1u);
  EXPECT_EQ(health.malformed, 2u);   // the flipped bit, the rubbish
  EXPECT_EQ(health.unanswered, 2u);  // the missing byte is waited for, as the whole answer is
}

TEST_F(NdiTracker, ADeviceThatForgotIsPreparedAgain) {
  for (const auto& [fault, why] :
       std::map<Fault, std::string>{{Fault::kError, "BX: ERROR0C: command not valid in the present mode"},
                                    {Fault::kReset, "the device was reset"}}) {
    Script what = script();
    what.faults = {{10, fault}};
    test::AuroraSimulator aurora(port(), what);
    Running running(quick(port()));
    ASSERT_TRUE(running.wait_for_states(3));
    EXPECT_EQ(running.states(), (std::vector<std::string>{"connected", why, "connected"}));
    ASSERT_TRUE(running.wait_for_frames(20));
    EXPECT_EQ(running.health().connections, 2u);
  }
}

TEST_F(NdiTracker, SilenceEndsTheConnection) {
  Script what = script();
  for (int i = 5; i < 8; ++i) what.faults[i] = Fault::kSilent;
  for (int i = 30; i < 40; ++i) what.faults[i] = Fault::kFlippedBit;
  test::AuroraSimulator aurora(port(), what);
  Running running(quick(port()));
  ASSERT_TRUE(running.wait_for_states(5));
  const auto states = running.states();
  EXPECT_EQ(states[1], "the device is silent");
  EXPECT_THAT(states[3], testing::HasSubstr("of the body: expected"));
  EXPECT_EQ(states[4], "connected");
}

TEST_F(NdiTracker, AToolPluggedInIsTaken) {
  Script what = script();
  what.port_occupied_from = 5;
  test::AuroraSimulator aurora(port(), what);
  Running running(quick(port()));
  ASSERT_TRUE(running.wait_for_states(3));
  ASSERT_TRUE(running.wait_for_frames(20));
  // The bit stays: once it is known it is no news.
  EXPECT_EQ(running.states(), (std::vector<std::string>{"connected", "a tool was plugged in", "connected"}));
}

TEST_F(NdiTracker, ThePortMayComeAndGo) {
  Running running(quick(port()));
  ASSERT_TRUE(running.wait_for_states(1));
  EXPECT_THAT(running.states()[0], testing::EndsWith("aurora: No such file or directory"));
  std::size_t frames = 0;
  for (std::size_t round = 1; round <= 5; ++round) {
    {
      test::AuroraSimulator aurora(port(), script());
      frames = running.frames().size() + 5;
      ASSERT_TRUE(running.wait_for_frames(frames)) << round;
    }
    ASSERT_TRUE(running.wait_for_states(2 * round + 1)) << round;
  }
  EXPECT_EQ(running.health().connections, 5u);
  EXPECT_LT(running.stop(), 0.2);
  const auto all = running.frames();
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_GT(all[i].time_s, all[i - 1].time_s);
    EXPECT_GT(all[i].number, all[i - 1].number);
  }
}

TEST_F(NdiTracker, ALineLeftInAnyStateIsTakenUp) {
  Script tracks = script(), slow = script(), wrong = script();
  tracks.tracks_already = true;
  slow.refuses_fast_line = true;
  wrong.wrong_init_checksum = true;
  for (const Script& what : {tracks, slow, wrong}) {
    test::AuroraSimulator aurora(port(), what);
    Running running(quick(port()));
    EXPECT_TRUE(running.wait_for_frames(5));
    EXPECT_EQ(running.states(), std::vector<std::string>{"connected"});
  }
}

TEST_F(NdiTracker, WhatIsNotThereIsTold) {
  Script one = script(), deaf = script();
  one.handles = 1;
  deaf.needs_break = true;
  {
    test::AuroraSimulator aurora(port(), one);
    Running running(quick(port()));
    ASSERT_TRUE(running.wait_for_states(1));
    EXPECT_EQ(running.states()[0], "2 sensors wanted; the device has 0A (port 1-0)");
  }
  test::AuroraSimulator aurora(port(), deaf);
  Running running(quick(port()));
  ASSERT_TRUE(running.wait_for_states(1));
  EXPECT_THAT(running.states()[0], testing::EndsWith("no answer at 9600 or 115200 baud, nor to a break"));
  EXPECT_LT(running.stop(), 0.2);
  Running file(quick(write("file", "no terminal")));
  ASSERT_TRUE(file.wait_for_states(1));
  EXPECT_THAT(file.states()[0], testing::EndsWith("file: no serial port"));
}

/// Silent from the first BX on: stop() comes in the midst of a wait.
TEST_F(NdiTracker, StopIsQuickWhateverGoesOn) {
  Script what = script();
  for (int i = 0; i < 100; ++i) what.faults[i] = Fault::kSilent;
  test::AuroraSimulator aurora(port(), what);
  TrackerOptions options = quick(port());
  options.device.reply_timeout_s = options.device.setup_timeout_s = 5.0;
  Running running(options);
  ASSERT_TRUE(running.wait_for_states(1));
  EXPECT_LT(running.stop(), 0.2);
}

TEST(NdiFrameClock, JitterIsSmoothedAndDriftFollowed) {
  std::mt19937 random(7);
  std::normal_distribution<double> jitter_s(0.0, 3e-3);
  constexpr double kPeriod_s = 0.025 * 1.0002;  // the device's crystal is 200 ppm slow
  FrameClock clock;
  double last_s = -1.0, square_s2 = 0.0, mean_s = 0.0;
  int counted = 0;
  for (int i = 0; i < 4000; ++i) {
    const double true_s = 100.0 + kPeriod_s * i, t_s = clock.stamp(1, true_s + jitter_s(random));
    EXPECT_GT(t_s, last_s);
    last_s = t_s;
    if (i < 1000) continue;
    ++counted;
    mean_s += t_s - true_s;
    square_s2 += (t_s - true_s) * (t_s - true_s);
  }
  // Output variance of the loop at a = 0.05: (2 a^2 + 2 b - 3 a b) / (a (4 - 2 a - b)) = 0.0378 of the input's, which
  // is 0.195 of its deviation, 0.59 ms; 30 % for the estimate from some 3000 correlated values.
  EXPECT_NEAR(std::sqrt(square_s2 / counted), 0.59e-3, 0.18e-3);
  EXPECT_NEAR(mean_s / counted, 0.0, 0.2e-3);
  EXPECT_NEAR(clock.period_s(), kPeriod_s, 0.25e-3);
}

TEST(NdiFrameClock, NeverRunsBack) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> late_s(0.0, 0.6);
  std::uniform_int_distribution<int> step(-3, 5);
  FrameClock clock;
  double last_s = clock.stamp(1, 10.0), host_s = 10.0;
  for (int i = 0; i < 10000; ++i) {
    host_s += 0.2 * late_s(random) - (i % 50 == 0 ? 0.5 : 0.0);  // even should the host's clock do so
    const double t_s = clock.stamp(step(random), host_s);
    ASSERT_GE(t_s, last_s + 0.99e-3);
    last_s = t_s;
  }
}

TEST(NdiFrameClock, LostFramesAndSilencesKeepTheirLength) {
  FrameClock clock;
  clock.stamp(1, 50.0);
  EXPECT_NEAR(clock.stamp(4, 50.1), 50.1, 1e-9);
  EXPECT_NEAR(clock.stamp(1, 53.0), 53.0, 1e-9);     // it said 1, but seconds have passed
  EXPECT_NEAR(clock.stamp(-100, 53.5), 53.5, 1e-9);  // the counter began anew
}

}  // namespace
}  // namespace palpate::ndi
