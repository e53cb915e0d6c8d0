// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <sys/resource.h>

#include <csignal>
#include <palpate/session/replay.hpp>
#include <tests/apps/run_program.hpp>
#include <tests/serve/frame_player.hpp>
#include <tests/serve/kept.hpp>
#include <tests/serve/serve_fixture.hpp>

/// Every frame is kept, whatever the disk does, and the force never waits for it (FAULTS 15, 16, 17, 25).
namespace palpate::serve_test {
namespace {

constexpr double kRate_hz = 250.0;

class ServeRecording : public Serve {
 protected:
  std::unique_ptr<ServeProcess> record(const std::string& keys = "") {
    return serve("[recording]\npath = \"s.palpate\"\n" + keys);
  }
  std::filesystem::path file() const { return path("s.palpate"); }
  static const nlohmann::json& recording(const nlohmann::json& health) { return health.at("recording"); }
  bool log_is_left() const { return std::filesystem::exists(file().string() + "-wal"); }

  /// What was sent is what is kept, to the last bit, each once; and a replay gives the same estimates.
  void expect_whole(const WireFrames& sent) const {
    const Session session = read(file());
    const std::vector<TrackerFrame> frames = tracker_frames(sent);
    ASSERT_EQ(session.frames.size(), frames.size());
    EXPECT_TRUE(session.damage.empty()) << session.damage.front();
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const TrackerFrame& kept = session.frames[i].frame;
      ASSERT_EQ(kept.time_s, frames[i].time_s) << i;
      for (std::size_t sensor = 0; sensor < 2; ++sensor) {
        ASSERT_EQ(kept.readings.at(sensor).position_m, frames[i].readings[sensor].position_m) << i;
        ASSERT_EQ(kept.readings.at(sensor).quaternion_wxyz, frames[i].readings[sensor].quaternion_wxyz) << i;
      }
    }
    expect_replay(frames.size());
  }
  /// By the library, which counts, and by the program, which a user has.
  void expect_replay(std::uint64_t frames) const {
    const session::ReplayReport report = session::replay(file());
    EXPECT_EQ(report.frames, frames);
    ASSERT_TRUE(report.identical()) << report.first->field << ": " << report.first->stored << ", now "
                                    << report.first->now;
    const test::ProgramRun run = test::run_program(PALPATE_BINARY, {"replay", file().string()}, path(""));
    EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  }

  WireFrames wire_ = virtual_wire(catheter_.catheter, kRate_hz, 4.0).frames;
};

TEST_F(ServeRecording, EveryFrameAndTheSameForcesAgain) {
  for (const double rate_hz : {40.0, 1000.0}) {
    std::filesystem::remove(file());
    const auto program = record();
    const auto screen = slicer(*program);
    const WireFrames sent =
        moved_to(virtual_wire(catheter_.catheter, rate_hz, rate_hz < 100.0 ? 1.0 : 2.0).frames, utc_s());
    plus_.play(sent, rate_hz);
    ASSERT_TRUE(screen->wait_for(sent.size(), 5.0));
    program->signal(SIGTERM);
    ASSERT_EQ(program->wait(5.0), 0) << program->err();
    EXPECT_FALSE(log_is_left());
    expect_whole(sent);
    const auto expected = offline(catheter_, sent);
    const Session session = read(file());
    for (std::size_t i = 0; i < expected.size(); ++i)
      ASSERT_EQ(session.frames.at(i).estimate.force_tip_N, expected[i].force_tip_N) << i;
    plus_.hang_up();
  }
}

TEST_F(ServeRecording, EndsWithinTwoSecondsUnderLoad) {
  const auto program = record();
  FramePlayer player(plus_, wire_, 1000.0);
  sleep_s(1.0);
  const Clock::time_point asked = Clock::now();
  program->signal(SIGTERM);
  ASSERT_EQ(program->wait(10.0), 0) << program->err();
  EXPECT_LT(seconds_since(asked), 2.0);
  RecordProperty("ended_after_ms", static_cast<int>(1e3 * seconds_since(asked)));
  WireFrames sent = player.stop();
  EXPECT_FALSE(log_is_left());
  const auto counted = program->summary()["catheters"][0]["frames"].get<std::size_t>();
  EXPECT_GT(counted, 500U);
  ASSERT_LE(counted, sent.size());
  sent.resize(counted);
  expect_whole(sent);
}

TEST_F(ServeRecording, KilledWhileWriting) {
  const int times = in_full() ? 100 : 5;
  std::uint64_t acknowledged = 0;
  for (int i = 0; i < times; ++i) {
    std::filesystem::remove(file());
    const auto program = record("batch_ms = 20\n");
    FramePlayer player(plus_, wire_, kRate_hz);
    sleep_s(0.25 + 0.0137 * (i % 17));
    const auto seen = recording(program->health())["committed_frames"].get<std::uint64_t>();
    program->signal(SIGKILL);
    ASSERT_EQ(program->wait(5.0), 128 + SIGKILL);
    const WireFrames sent = player.stop();
    plus_.hang_up();
    {
      const Session session = read(file());
      ASSERT_GE(session.frames.size(), seen) << "acknowledged, and lost";
      ASSERT_LE(session.frames.size(), sent.size());
      EXPECT_TRUE(session.damage.empty()) << session.damage.front();
      for (std::size_t k = 0; k < session.frames.size(); ++k)
        ASSERT_EQ(session.frames[k].frame.time_s, sent[k].time_s) << k;
      expect_replay(session.frames.size());
    }
    EXPECT_EQ(Connection(file()).ask("PRAGMA integrity_check"), "ok");
    acknowledged += seen;
    for (const char* const ending : {"", "-wal", "-shm"}) std::filesystem::remove(file().string() + ending);
  }
  EXPECT_GT(acknowledged, 0U);
  RecordProperty("acknowledged_frames", std::to_string(acknowledged));
}

TEST_F(ServeRecording, DiskFull) {
  const auto program = record();
  const auto screen = slicer(*program);
  FramePlayer player(plus_, wire_, kRate_hz);
  health_when(
      *program, [](const auto& h) { return recording(h)["committed_frames"] > 50; }, 5.0);
  rlimit limit{};
  ASSERT_EQ(::prlimit(program->pid(), RLIMIT_FSIZE, nullptr, &limit), 0);
  const rlimit full{4096, limit.rlim_max};
  ASSERT_EQ(::prlimit(program->pid(), RLIMIT_FSIZE, &full, nullptr), 0);
  const Clock::time_point filled = Clock::now();
  const auto failing = health_when(
      *program, [](const auto& h) { return recording(h)["failing"].template get<bool>(); }, 5.0);
  EXPECT_LT(seconds_since(filled), 1.0 + 0.5);
  RecordProperty("alarm_after_ms", static_cast<int>(1e3 * seconds_since(filled)));
  EXPECT_NE(recording(failing)["error"], "");
  EXPECT_TRUE(screen->wait_for_live(1.0)) << "the force waits for the disk";
  sleep_s(1.0);
  EXPECT_TRUE(screen->wait_for_live(1.0));

  ASSERT_EQ(::prlimit(program->pid(), RLIMIT_FSIZE, &limit, nullptr), 0);
  health_when(
      *program, [](const auto& h) { return !recording(h)["failing"].template get<bool>(); }, 5.0);
  const WireFrames sent = player.stop();
  ASSERT_TRUE(screen->wait_for(sent.size(), 5.0)) << "frames were lost on the way to the screen";
  program->signal(SIGTERM);
  ASSERT_EQ(program->wait(5.0), 0) << program->err();
  EXPECT_EQ(program->summary()["recording"]["dropped"], 0);
  expect_whole(sent);
}

/// Another program holds the file: records wait, then are dropped and counted, and the force does not notice.
TEST_F(ServeRecording, LockedByAnotherProgram) {
  const double locked_s = in_full() ? 5.0 : 2.0;
  const auto program = record("queue = 64\n");
  const auto screen = slicer(*program);
  FramePlayer player(plus_, wire_, kRate_hz);
  health_when(
      *program, [](const auto& h) { return recording(h)["committed_frames"] > 50; }, 5.0);
  const auto before = program->health();
  nlohmann::json locked;
  {
    const Connection other(file());
    ASSERT_EQ(other.ask("PRAGMA busy_timeout = 2000"), "2000");
    ASSERT_EQ(other.ask("BEGIN IMMEDIATE"), "done");
    const std::size_t shown = screen->forces().size();
    sleep_s(locked_s);
    const double rate_hz = static_cast<double>(screen->forces().size() - shown) / locked_s;
    EXPECT_GT(rate_hz, 0.9 * kRate_hz) << "the force waits for the disk";
    locked = program->health();
    EXPECT_TRUE(recording(locked)["failing"].get<bool>());
    EXPECT_GT(recording(locked)["dropped"], 0);
    ASSERT_EQ(other.ask("COMMIT"), "done");
  }
  health_when(
      *program, [](const auto& h) { return !recording(h)["failing"].template get<bool>(); }, 5.0);
  RecordProperty("observer_p99_before_s", before["latency"]["p99_s"].dump());
  RecordProperty("observer_p99_locked_s", locked["latency"]["p99_s"].dump());
  sleep_s(0.5);
  const WireFrames sent = player.stop();
  ASSERT_TRUE(screen->wait_for(sent.size(), 5.0)) << "frames were lost on the way to the screen";
  program->signal(SIGTERM);
  EXPECT_EQ(program->wait(5.0), 1) << "records were lost: " << program->err();
  auto health = program->summary();
  EXPECT_EQ(health["catheters"][0]["queue_dropped"], 0);
  EXPECT_EQ(health["network_dropped"], 0);
  const Session session = read(file());
  EXPECT_EQ(session.frames.size() + health["recording"]["dropped"].get<std::size_t>(), sent.size());
  EXPECT_EQ(std::count(session.events.begin(), session.events.end(), "dropped"), 1);
}

}  // namespace
}  // namespace palpate::serve_test
