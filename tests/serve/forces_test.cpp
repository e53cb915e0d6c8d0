// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <tests/serve/serve_fixture.hpp>

/// End to end: a virtual recording goes in as PLUS sends it, the forces that 3D Slicer gets are those of the offline
/// run, to the last bit.
namespace palpate::serve_test {
namespace {

class ServeForces : public Serve {
 protected:
  /// Plays at the rate; forces against offline, latencies said.
  void compare(double rate_hz, double duration_s) {
    const VirtualWire wire = virtual_wire(catheter_.catheter, rate_hz, duration_s);
    const auto program = serve();
    const auto screen = slicer(*program);
    const WireFrames frames = moved_to(wire.frames, utc_s());
    const auto sent = plus_.play(frames, rate_hz);
    ASSERT_TRUE(screen->wait_for(frames.size(), 10.0)) << program->health().dump();
    const auto came = screen->forces();  // at once: soon it is silent, and a force that is none follows
    expect_equal_forces(came, offline(catheter_, frames), frames, sent);
    EXPECT_EQ(screen->fault(), "");
    report(latencies_s(came, sent), rate_hz);
    auto health = program->health();
    EXPECT_EQ(health["catheters"][0]["frames"], frames.size());
    EXPECT_EQ(health["catheters"][0]["queue_dropped"], 0);
    EXPECT_EQ(health["network_dropped"], 0);
    EXPECT_EQ(health["openigtlink"]["dropped"], 0);
    for (const char* const type : {"TRANSFORM", "POLYDATA", "STRING"}) EXPECT_GT(screen->count(type), 10U) << type;
  }

  void report(const std::vector<double>& latencies, double rate_hz) {
    for (const auto& [name, share] : {std::pair{"p50", 0.5}, {"p99", 0.99}, {"p99_9", 0.999}, {"most", 1.0}}) {
      const double value_us = 1e6 * percentile_s(latencies, share);
      RecordProperty(fmt::format("latency_{}_us", name), fmt::format("{:.0f}", value_us));
      fmt::print("socket to socket at {} Hz: {} {:.0f} us\n", rate_hz, name, value_us);
    }
    EXPECT_LT(percentile_s(latencies, 0.99), 0.25);
  }
};

TEST_F(ServeForces, EqualOfflineAt40Hz) { compare(40.0, in_full() ? 60.0 : 2.5); }

TEST_F(ServeForces, EqualOfflineAt1kHz) { compare(1000.0, in_full() ? 60.0 : 2.5); }

TEST_F(ServeForces, InTheBaseToo) {
  const auto program = serve();
  const auto screen = slicer(*program);
  const WireFrames frames = moved_to(beating().frames, utc_s());
  plus_.play(frames, 200.0, 0, 40);
  ASSERT_TRUE(screen->wait_for(40, 5.0, "cForceBase"));
  const auto expected = offline(catheter_, frames);
  const auto came = screen->forces("cForceBase");
  for (std::size_t i = 0; i < 40; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (came[i].live()) {
        EXPECT_EQ(came[i].values[axis], expected[i].force_base_N(static_cast<Eigen::Index>(axis)));
      }
  EXPECT_TRUE(came.back().live());
}

TEST_F(ServeForces, FromTrackingData) {
  const auto program = serve();
  const auto screen = slicer(*program);
  WireFrames frames = moved_to(beating().frames, utc_s());
  frames.resize(40);
  for (WireFrame& frame : frames) frame.poses = {{"Tip", frame.of(kTip)}, {"Shaft", frame.of(kShaft)}};
  std::vector<Clock::time_point> sent;
  for (const WireFrame& frame : frames) {
    sent.push_back(Clock::now());
    ASSERT_TRUE(plus_.send_tracking_data(frame));
    sleep_s(0.005);
  }
  ASSERT_TRUE(screen->wait_for(frames.size(), 5.0));
  const auto came = screen->forces();
  for (WireFrame& frame : frames) frame.poses = {{kTip, frame.of("Tip")}, {kShaft, frame.of("Shaft")}};
  expect_equal_forces(came, offline(catheter_, frames), frames, sent);
}

/// The check above can fail: another force is seen.
TEST_F(ServeForces, ADifferentPoseGivesADifferentForce) {
  const auto program = serve();
  const auto screen = slicer(*program);
  WireFrames frames = moved_to(beating().frames, utc_s());
  plus_.play(frames, 200.0, 0, 40);
  ASSERT_TRUE(screen->wait_for(40, 5.0));
  frames[39].of(kTip).columns[9] += 0.01F;
  frames.resize(40);
  EXPECT_NE(screen->forces().back().values[0], offline(catheter_, frames).back().force_tip_N.x());
}

}  // namespace
}  // namespace palpate::serve_test
