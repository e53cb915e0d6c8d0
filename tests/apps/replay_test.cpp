// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <palpate/store/database.hpp>
#include <tests/apps/app_fixture.hpp>
#include <tests/session/recorded_session.hpp>

namespace palpate::test {
namespace {

using ::testing::HasSubstr;

class ReplayVerb : public App {
 protected:
  void SetUp() override {
    App::SetUp();
    record_session(path("s"), "one", beating_recording().catheter, path("r.csv"));
  }
};

TEST_F(ReplayVerb, SaysThatEveryEstimateIsIdenticalAndWritesThem) {
  const ProgramRun run = palpate({"replay", "s", "--out", "again.csv"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("identical to the last bit"));
  EXPECT_EQ(run.err, "");
  ASSERT_EQ(estimate().exit_code, 0);
  EXPECT_EQ(contents(path("again.csv")), contents(path("e.csv")));  // the offline estimate of the same recording
}

TEST_F(ReplayVerb, NamesTheNumberThatIsNotTheSame) {
  store::Database(path("s")).execute("UPDATE estimate SET cov_xz_N2 = 0.125 WHERE id = 33");
  const ProgramRun text = palpate({"replay", "s"}), json = palpate({"replay", "s", "--json"});
  EXPECT_EQ(text.exit_code, 1);
  EXPECT_THAT(text.out, HasSubstr("catheter \"one\", frame 32 at 0.8 s: cov_xz_N2: stored 0.125, now "));
  EXPECT_THAT(text.err, HasSubstr("palpate: warning: "));
  EXPECT_EQ(json.exit_code, 1);
  const nlohmann::json verdict = nlohmann::json::parse(json.out);
  EXPECT_EQ(verdict["identical"], false);
  EXPECT_EQ(verdict["different"], 1);
  EXPECT_EQ(verdict["first_difference"]["field"], "cov_xz_N2");
  EXPECT_EQ(verdict["first_difference"]["frame"], 32);
}

TEST_F(ReplayVerb, RefusesWhatIsNoSession) {
  EXPECT_THAT(refusal({"replay", "none"}), HasSubstr("none: cannot be read"));
  EXPECT_THAT(refusal({"replay", "r.csv", "--out", "x.csv"}), HasSubstr("r.csv: does not begin as SQLite files do"));
  EXPECT_THAT(refusal({"replay", "s", "--catheter", "two"}), HasSubstr("catheter \"two\": expected one of its 1: one"));
  EXPECT_THAT(refusal({"replay", "s", "--out", "s"}), HasSubstr("expected another file than the session"));
  EXPECT_THAT(palpate({"replay", "--help"}).out, HasSubstr("Example: palpate replay"));
}

}  // namespace
}  // namespace palpate::test
