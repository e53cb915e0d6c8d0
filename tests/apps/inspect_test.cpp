// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <palpate/store/database.hpp>
#include <tests/apps/app_fixture.hpp>
#include <tests/session/recorded_session.hpp>

namespace palpate::test {
namespace {

using ::testing::HasSubstr;

class InspectVerb : public App {
 protected:
  void SetUp() override {
    App::SetUp();
    record_session(path("s"), "one", beating_recording().catheter, path("r.csv"));
  }
};

TEST_F(InspectVerb, TellsWhatIsInASession) {
  const ProgramRun text = palpate({"inspect", "s", "--full"}), json = palpate({"inspect", "s", "--json"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("160 frames from 0.000 s to 3.975 s, 40 Hz"));
  EXPECT_THAT(text.out, HasSubstr("whole (full check)"));
  const nlohmann::json told = nlohmann::json::parse(json.out);
  EXPECT_EQ(told["whole"], true);
  EXPECT_EQ(told["schema_version"], 1);
  EXPECT_EQ(told["program_version"], "test");
  EXPECT_EQ(told["events"]["note"], 1);
  EXPECT_EQ(told["catheters"][0]["frames"], 160);
  EXPECT_EQ(told["catheters"][0]["sensors"][1]["name"], "shaft");
}

TEST_F(InspectVerb, TellsGaps) {
  RecordingText recording = beating_recording().tracker;
  std::erase_if(recording.rows, [](const auto& row) { return std::stod(row[0]) > 1.0 && std::stod(row[0]) < 2.0; });
  write("gap.csv", recording.text());
  record_session(path("g"), "one", beating_recording().catheter, path("gap.csv"));
  const nlohmann::json told = nlohmann::json::parse(palpate({"inspect", "g", "--json"}).out);
  ASSERT_EQ(told["catheters"][0]["gaps"].size(), 1u);
  EXPECT_EQ(told["catheters"][0]["gaps"][0]["from_s"], 1.0);
  EXPECT_EQ(told["catheters"][0]["gaps"][0]["to_s"], 2.0);
}

TEST_F(InspectVerb, SaysWhereASessionIsDamaged) {
  std::string bytes = contents(path("s"));
  const std::size_t page = bytes.size() / 4096 / 2;
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(page * 4096), 4096, '\0');
  write("bad", bytes);
  const ProgramRun run = palpate({"inspect", "bad"});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_THAT(run.out, HasSubstr(fmt::format("page {}, byte {}", page + 1, page * 4096)));
  const nlohmann::json told = nlohmann::json::parse(palpate({"inspect", "bad", "--json"}).out);
  EXPECT_EQ(told["whole"], false);
  EXPECT_GT(told["lost"], 0);
  EXPECT_EQ(told["catheters"][0]["frames"].get<int>() + told["lost"].get<int>(), 160);
}

TEST_F(InspectVerb, RefusesWhatIsNoSession) {
  EXPECT_THAT(refusal({"inspect", "none"}), HasSubstr("none: cannot be read"));
  EXPECT_THAT(refusal({"inspect", "c.toml"}), HasSubstr("does not begin as SQLite files do"));
  EXPECT_THAT(palpate({"inspect", "--help"}).out, HasSubstr("Example: palpate inspect"));
}

}  // namespace
}  // namespace palpate::test
