// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <palpate/recording/csv_writers.hpp>
#include <tests/serve/frame_player.hpp>
#include <tests/serve/serve_fixture.hpp>

/// Much to do and little to do it with: many catheters, a starved processor, a long run (FAULTS 20, 22; issue 8, 3).
namespace palpate::serve_test {
namespace {

class ServeLoad : public Serve {
 protected:
  /// Catheters c0, c1, ..., each of which plays the same recording of that rate again and again.
  std::unique_ptr<ServeProcess> serve_files(int catheters, double rate_hz, double speed, const std::string& more = "") {
    const VirtualRecording made =
        simulate_tracker(catheter_.catheter, beating_wall_force, {.rate_hz = rate_hz, .duration_s = 4.0, .seed = 3});
    write_tracker_csv(path("r.csv"), catheter_.catheter, made.frames);
    std::string text = "schema = 1\n" + more;
    for (int i = 0; i < catheters; ++i)
      text += fmt::format(
          "[[catheter]]\nname = \"c{}\"\nfile = \"c.toml\"\n"
          "source = {{ kind = \"file\", path = \"r.csv\", loop = true, speed = {:.1f} }}\n",
          i, speed);
    write("serve.toml", text);
    return std::make_unique<ServeProcess>(
        path(""),
        std::vector<std::string>{path("serve.toml").string(), "--openigtlink-port", "0", "--dashboard-port", "0"});
  }
};

TEST_F(ServeLoad, SixtyFourCathetersAt250Hz) {
  constexpr int kCatheters = 64;
  constexpr double kRate_hz = 250.0;
  const double duration_s = in_full() ? 60.0 : 3.0;
  const auto program = serve_files(kCatheters, kRate_hz, 1.0, "[recording]\npath = \"s.palpate\"\n");
  sleep_s(1.0);
  const Clock::time_point start = Clock::now();
  const double cpu_before_s = program->cpu_s();
  sleep_s(duration_s);
  const double share = (program->cpu_s() - cpu_before_s) / seconds_since(start);
  program->signal(SIGTERM);
  ASSERT_EQ(program->wait(10.0), 0) << program->err();
  auto health = program->summary();
  for (const auto& catheter : health["catheters"]) {
    EXPECT_EQ(catheter["queue_dropped"], 0);
    EXPECT_GT(catheter["frames"].get<double>(), 0.95 * duration_s * kRate_hz);
  }
  EXPECT_EQ(health["network_dropped"], 0);
  EXPECT_EQ(health["recording"]["dropped"], 0);
  EXPECT_EQ(health["recording"]["committed"], health["recording"]["offered"]);
  const auto& latency = health["latency"];
  const std::string figures =
      fmt::format("{:.0f} % of a core, latency p50 {} s, p99 {} s, p99.9 {} s, most {} s, {} frames", 100.0 * share,
                  latency["p50_s"].dump(), latency["p99_s"].dump(), latency["p99_9_s"].dump(), latency["most_s"].dump(),
                  health["recording"]["committed_frames"].dump());
  RecordProperty("sixty_four_catheters", figures);
  fmt::print("64 catheters at 250 Hz, recorded: {}\n", figures);
}

/// Stopped for half a second: what was lost in time is said, nothing old is shown as live for long, and it recovers.
TEST_F(ServeLoad, StoppedForHalfASecond) {
  const auto program = serve();
  const auto screen = slicer(*program);
  FramePlayer player(plus_, virtual_wire(catheter_.catheter, 250.0, 4.0).frames, 250.0);
  ASSERT_TRUE(screen->wait_for(250, 10.0));
  const auto before = program->catheter();
  program->signal(SIGSTOP);
  sleep_s(0.5);
  program->signal(SIGCONT);
  auto after = health_when(
      *program,
      [&](const auto& h) {
        const auto& c = h["catheters"][0];
        return c["misses"] > before["misses"] || c["stale"] > before["stale"];
      },
      1.0);
  const auto& stopped = after["catheters"][0];
  EXPECT_NE(stopped["state"], "LIVE") << stopped.dump();
  EXPECT_FALSE(stopped["words"].empty()) << stopped.dump();
  EXPECT_TRUE(screen->wait_for_live(5.0));
  const std::size_t sent = player.stop().size();
  EXPECT_TRUE(screen->wait_for(sent, 5.0));
  EXPECT_EQ(program->catheter()["frames"], sent);
}

/// A process that gets a quarter of its processor, in slices: what waits for 0.15 s is older than what may be shown.
TEST_F(ServeLoad, StarvedProcessor) {
  const auto program = serve();
  const auto screen = slicer(*program);
  FramePlayer player(plus_, virtual_wire(catheter_.catheter, 250.0, 4.0).frames, 250.0);
  ASSERT_TRUE(screen->wait_for(250, 10.0));
  const auto misses = program->catheter()["misses"].get<std::uint64_t>();
  for (int i = 0; i < 6; ++i) {
    program->signal(SIGSTOP);
    sleep_s(0.15);
    program->signal(SIGCONT);
    sleep_s(0.05);
  }
  auto catheter = program->catheter();
  EXPECT_GT(catheter["misses"], misses) << catheter.dump();
  EXPECT_EQ(catheter["state"], "DEGRADED") << catheter.dump();
  EXPECT_NE(catheter["words"].dump().find("late"), std::string::npos) << catheter.dump();
  EXPECT_TRUE(screen->wait_for_live(5.0));
  health_when(
      *program, [](const auto& h) { return h["catheters"][0]["state"] == "LIVE"; }, 20.0);
}

TEST_F(ServeLoad, MemoryStaysFlat) {
  const auto program = serve_files(1, 1000.0, 0.0);
  sleep_s(2.0);
  const auto frames = program->catheter()["frames"].get<std::uint64_t>();  // the first request takes its buffers
  const double before_MB = program->memory_MB();
  sleep_s(in_full() ? 600.0 : 3.0);
  const auto passed = program->catheter()["frames"].get<std::uint64_t>() - frames;
  RecordProperty("memory", fmt::format("{:.2f} -> {:.2f} MB in {} frames", before_MB, program->memory_MB(), passed));
  EXPECT_GT(passed, 10000U);
  EXPECT_NEAR(program->memory_MB(), before_MB, 0.02 * before_MB);
}

}  // namespace
}  // namespace palpate::serve_test
