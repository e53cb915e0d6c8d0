// SPDX-License-Identifier: Apache-2.0

#include <Eigen/Geometry>
#include <algorithm>
#include <csignal>
#include <palpate/session/reader.hpp>
#include <tests/apps/run_program.hpp>
#include <tests/serve/frame_player.hpp>
#include <tests/serve/serve_fixture.hpp>

/// What an operator does while forces flow: each is an event of the recording, and a replay does the same again.
namespace palpate::serve_test {
namespace {

class ServeControl : public Serve {
 protected:
  std::unique_ptr<ServeProcess> record() { return serve("[recording]\npath = \"s.palpate\"\n"); }
  void end(ServeProcess& program) const {
    program.signal(SIGTERM);
    ASSERT_EQ(program.wait(5.0), 0) << program.err();
  }
  std::vector<std::string> events() const {
    std::vector<std::string> out;
    session::SessionReader reader(path("s.palpate"));
    session::LiveRecord record;
    while (reader.next(record))
      if (record.kind == session::LiveRecord::Kind::kEvent) out.push_back(record.event);
    return out;
  }
  void expect_replay() const {
    const test::ProgramRun run = test::run_program(PALPATE_BINARY, {"replay", path("s.palpate").string()}, path(""));
    EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  }
  WireFrames wire_ = virtual_wire(catheter_.catheter, 100.0, 4.0).frames;
};

TEST_F(ServeControl, NotesAreKept) {
  const auto program = record();
  FramePlayer player(plus_, wire_, 100.0);
  sleep_s(0.3);
  EXPECT_EQ(program->post("/api/notes", {{"text", "contact"}, {"catheter", "c"}})["http"], 200);
  EXPECT_EQ(program->post("/api/notes", {{"text", "contact"}, {"catheter", "d"}})["http"], 400);
  EXPECT_EQ(program->post("/api/notes", {{"txt", "contact"}})["http"], 400);
  EXPECT_EQ(program->post("/api/catheters/d/tare", nlohmann::json::object())["http"], 404);
  player.stop();
  end(*program);
  const auto all = events();
  EXPECT_EQ(std::count(all.begin(), all.end(), "note"), 1);
  EXPECT_EQ(std::count(all.begin(), all.end(), "connected"), 1);
}

/// A clamp that was registered anew, a little off: from then on the forces are others, and a replay finds the same.
TEST_F(ServeControl, ABaseRegisteredAnewIsReplayed) {
  const auto program = record();
  const auto screen = slicer(*program);
  FramePlayer player(plus_, wire_, 100.0);
  ASSERT_TRUE(screen->wait_for(50, 5.0));
  const nlohmann::json body{{"position_mm", {20.0, -40.0, -179.8}},
                            {"quaternion_wxyz", {0.7071067811865476, 0.0, 0.7071067811865476, 0.0}}};
  EXPECT_EQ(program->post("/api/catheters/c/base", body)["http"], 200);
  ASSERT_TRUE(screen->wait_for(screen->forces().size() + 50, 5.0));
  player.stop();
  end(*program);
  const auto all = events();
  EXPECT_EQ(std::count(all.begin(), all.end(), "base"), 1);
  expect_replay();
}

}  // namespace
}  // namespace palpate::serve_test
