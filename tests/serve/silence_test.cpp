// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <palpate/link/codec.hpp>
#include <tests/serve/serve_fixture.hpp>

/// A sensor that is lost is silence: an old force is never shown as a live one (FAULTS 1, 2, 10).
namespace palpate::serve_test {
namespace {

constexpr double kMargin_s = 0.15;  // of a machine that does other things as well

std::size_t count_live(const std::vector<SlicerClient::Force>& forces) {
  return static_cast<std::size_t>(
      std::count_if(forces.begin(), forces.end(), [](const SlicerClient::Force& force) { return force.live(); }));
}

class ServeSilence : public Serve {
 protected:
  /// `frames` at the rate, then nothing: STALE and NaN within the limit, live again within five frames.
  void fall_silent(double rate_hz, double limit_s) {
    const auto program = serve();
    const auto screen = slicer(*program);
    const WireFrames frames = moved_to(virtual_wire(catheter_.catheter, rate_hz, 40.0 / rate_hz).frames, utc_s());
    const auto last_sent = plus_.play(frames, rate_hz, 0, 30).back();
    // Before the period is known, the least silence counts: a slow source is stale once after its first frame.
    const auto is_silent = [&] {
      const auto forces = screen->forces();
      return count_live(forces) == 30 && !forces.back().live();
    };
    ASSERT_TRUE(eventually(is_silent, limit_s + 2.0)) << "nothing said that the force is not live any more";
    const std::size_t count = screen->forces().size();
    sleep_s(0.2);
    const auto forces = screen->forces();
    ASSERT_EQ(forces.size(), count) << "the old force was sent again";
    const double silent_s = std::chrono::duration<double>(forces.back().received - last_sent).count();
    EXPECT_LT(silent_s, limit_s + kMargin_s);
    EXPECT_GT(silent_s, 0.8 * limit_s) << "not silent yet";
    RecordProperty("stale_after_ms", static_cast<int>(1e3 * silent_s));
    EXPECT_GT(forces[count - 1].values[3], forces[count - 2].values[3]) << "sigma does not grow";
    auto catheter = program->catheter();
    EXPECT_EQ(catheter["state"], "STALE");
    EXPECT_TRUE(catheter["force_tip_N"].is_null());
    EXPECT_EQ(catheter["stale"], count - 30);
    EXPECT_EQ(screen->health()["state"], "STALE");

    plus_.play(moved_to({frames.begin() + 30, frames.end()}, utc_s()), rate_hz, 0, 5);
    ASSERT_TRUE(screen->wait_for(count + 5, 5.0));
    EXPECT_TRUE(screen->forces()[count + 4].live());
    EXPECT_GE(count_live(screen->forces()), 31U);
    EXPECT_NE(program->catheter()["state"], "WAITING");
  }
};

TEST_F(ServeSilence, StaleAfter100msAt40Hz) { fall_silent(40.0, 0.1); }
TEST_F(ServeSilence, StaleAfter100msAt1kHz) { fall_silent(1000.0, 0.1); }
TEST_F(ServeSilence, StaleAfterThreePeriodsAt10Hz) { fall_silent(10.0, 0.3); }

/// PLUS does not send what it does not see.
TEST_F(ServeSilence, ASensorThatIsLeftOut) {
  const auto program = serve();
  const auto screen = slicer(*program);
  const WireFrames whole = moved_to(virtual_wire(catheter_.catheter, 100.0, 0.6).frames, utc_s());
  WireFrames frames = whole;
  for (std::size_t i = 40; i < 60; ++i) std::erase_if(frames[i].poses, [](const auto& p) { return p.first == kShaft; });
  const auto sent = plus_.play(frames, 100.0);
  ASSERT_TRUE(screen->wait_for(60, 5.0));
  const auto forces = screen->forces();
  expect_equal_forces(forces, offline(catheter_, frames), frames, sent);
  const Vector3d with_both = offline(catheter_, whole)[59].covariance_tip_N2.diagonal().cwiseSqrt();
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_GT(forces[59].values[static_cast<std::size_t>(axis + 3)], 1.02 * with_both(axis)) << axis;
  auto sensors = program->catheter()["sensors"];
  EXPECT_EQ(sensors["Shaft"]["missing"], 20);
  EXPECT_EQ(sensors["Shaft"]["usable"], 40);
  EXPECT_EQ(sensors["Tip"]["usable"], 60);
}

/// Version 2 of the header says it in words; the pose beside them is the last one, as PLUS has it.
TEST_F(ServeSilence, MissingByMetadata) {
  const auto program = serve();
  const auto screen = slicer(*program);
  const WireFrames frames = moved_to(virtual_wire(catheter_.catheter, 100.0, 0.6).frames, utc_s());
  plus_.play(frames, 100.0, 0, 40);
  for (std::size_t i = 40; i < 60; ++i) {
    std::vector<std::byte> bytes;
    for (const auto& [device, matrix] : frames[39].poses)
      link::encode({.version = 2,
                    .device = device,
                    .time_s = frames[i].time_s,
                    .body = link::Transform{matrix},
                    .metadata = {{"TransformValid", "false"}, {"TransformStatus", "OUT_OF_VIEW"}}},
                   bytes);
    ASSERT_TRUE(plus_.send_raw(bytes));
    sleep_s(0.01);
  }
  ASSERT_TRUE(screen->wait_for(60, 5.0));
  const auto forces = screen->forces();
  for (std::size_t i = 40; i < 60; ++i) {
    EXPECT_FALSE(forces[i].live()) << i;
    for (std::size_t axis = 3; axis < 6; ++axis) EXPECT_GT(forces[i].values[axis], forces[i - 1].values[axis]) << i;
  }
  auto catheter = program->catheter();
  EXPECT_EQ(catheter["sensors"]["Tip"]["missing"], 20);
  EXPECT_EQ(catheter["sensors"]["Shaft"]["missing"], 20);
  EXPECT_EQ(catheter["statuses"]["HELD"], 20);
  EXPECT_TRUE(catheter["force_tip_N"].is_null());
}

/// A peer that is gone without a word: its connection stays open, nothing comes.
TEST_F(ServeSilence, HalfOpenConnection) {
  const auto program = serve();
  const auto screen = slicer(*program);
  const WireFrames frames = beating().frames;
  const Clock::time_point last_byte = plus_.play(moved_to(frames, utc_s()), 40.0, 0, 20).back();
  ASSERT_TRUE(screen->wait_for(20, 5.0));
  auto health = health_when(
      *program, [](const auto& h) { return !h["sources"][0]["connected"].template get<bool>(); }, 3.0);
  EXPECT_LT(seconds_since(last_byte), 2.0);
  EXPECT_NE(health["sources"][0]["error"].get<std::string>().find("silent"), std::string::npos) << health.dump();
  ASSERT_TRUE(plus_.accept(5.0)) << "no second connection";
  const std::size_t before = screen->forces().size();
  plus_.play(moved_to(frames, utc_s()), 40.0, 0, 10);
  ASSERT_TRUE(screen->wait_for(before + 10, 5.0));
  EXPECT_TRUE(screen->forces().back().live());
}

}  // namespace
}  // namespace palpate::serve_test
