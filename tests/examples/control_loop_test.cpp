// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <examples/04_control_loop.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <tests/observer/allocation_counter.hpp>
#include <tests/observer/layouts.hpp>

/// The loop of examples/04_control_loop.hpp, as it stands there: no allocation in any of its steps, and no force while
/// the tracker is silent.
namespace palpate {
namespace {

constexpr double kJump_s = 0.15;
constexpr double kSilent_s = 0.20, kAgain_s = 0.35;

/// Nothing, then 0.2 N at once: the search for a jump is a part of the loop.
Vector3d jumping_force(double time_s) { return time_s < kJump_s ? Vector3d::Zero() : Vector3d(0.05, 0.1, -0.15); }

/// A cycle is a millisecond of its clock. One frame of readings all missing, and a silence of 150 ms.
struct ScriptedTracker {
  const std::vector<TrackerFrame>& frames;
  int cycles = 0;
  std::size_t next = 0;
  double now_s() { return 1e-3 * cycles++; }
  bool poll(TrackerFrame& frame) {
    if (next == frames.size() || frames[next].time_s > 1e-3 * cycles) return false;
    frame = frames[next];
    if (next++ == 2)
      for (SensorReading& reading : frame.readings) reading.status = SensorReading::Status::kMissing;
    return frame.time_s < kSilent_s || frame.time_s > kAgain_s;
  }
};

struct NotingRobot {
  int most_cycles = 0;
  bool allocates = false;
  int applied = 0, held = 0;
  Vector3d last_N = Vector3d::Zero();
  bool running() const { return applied + held < most_cycles; }
  void hold() { ++held; }
  void apply(const ForceGaussian& force) {
    ++applied;
    last_N = force.mean_N;
    if (allocates) delete new volatile int(applied);
  }
};

struct Run {
  std::size_t allocations;
  NotingRobot robot;
};

Run run_loop(bool robot_allocates) {
  const Catheter catheter = test::two_sensors();
  const VirtualRecording recording = simulate_tracker(catheter, jumping_force, {.duration_s = 0.6, .seed = 3});
  ForceObserver observer(catheter, {});
  TrackerFrame frame = recording.frames.front();
  ScriptedTracker tracker{.frames = recording.frames};
  Run run{.allocations = 0, .robot = {.most_cycles = 500, .allocates = robot_allocates}};
  const test::CountAllocations count;
  control_loop(observer, frame, tracker, run.robot);
  run.allocations = count.so_far();
  return run;
}

TEST(ControlLoopExample, AllocatesNothing) { EXPECT_EQ(run_loop(false).allocations, 0U); }

TEST(ControlLoopExample, CounterSeesAnAllocationInIt) { EXPECT_GE(run_loop(true).allocations, 300U); }

/// Held: before the first frame at 0 s nothing; from the last measured frame before the silence (0.175 or 0.2 s) plus
/// 0.1 s until the first one after it (0.375 s).
TEST(ControlLoopExample, HoldsWhileTheTrackerIsSilentAndFindsTheForce) {
  const NotingRobot robot = run_loop(false).robot;
  EXPECT_GE(robot.held, 70);
  EXPECT_LE(robot.held, 110);
  EXPECT_LT((robot.last_N - jumping_force(0.5)).norm(), 0.04);
}

}  // namespace
}  // namespace palpate
