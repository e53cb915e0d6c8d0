// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;
using Words = std::vector<std::string>;

/// A real shell is asked what it would propose.
class Completion : public test::App {
 protected:
  void SetUp() override {
    test::App::SetUp();
    ASSERT_EQ(palpate({"completion", "bash", "--out", "completion.bash"}).exit_code, 0);
    std::filesystem::create_directory(path("deep"));
    write("a file.csv", "");
  }

  /// What bash proposes for the last of `typed`, which follow "palpate".
  Words proposed(const Words& typed) const {
    std::string words = "palpate";
    for (const std::string& word : typed) words += " '" + word + "'";
    write("ask.bash", "set -u\nsource completion.bash\nCOMP_WORDS=(" + words +
                          ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_palpate\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
    const test::ProgramRun run = test::run_program("/bin/bash", {"--norc", "ask.bash"}, path(""));
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_EQ(run.err, "");
    Words answers;
    std::istringstream lines(run.out);
    for (std::string line; std::getline(lines, line);)
      if (!line.empty()) answers.push_back(line);
    return answers;
  }

  /// A shell's own check of a script's syntax; true where there is no such shell.
  bool syntax_is_good(const std::string& shell) const {
    const std::string program = "/usr/bin/" + shell;
    if (!std::filesystem::exists(program)) return true;
    EXPECT_EQ(palpate({"completion", shell, "--out", "script"}).exit_code, 0);
    const test::ProgramRun run = test::run_program(program, {"-n", "script"}, path(""));
    EXPECT_EQ(run.err, "");
    return run.exit_code == 0;
  }
};

TEST_F(Completion, Commands) {
  EXPECT_THAT(proposed({"es"}), ElementsAre("estimate"));
  EXPECT_THAT(proposed({""}), testing::AllOf(Contains("estimate"), Contains("identify"), Not(Contains("completion")),
                                             Not(Contains("c.toml"))));
  EXPECT_THAT(proposed({"identify", ""}),
              UnorderedElementsAre("stiffness", "precurvature", "registration", "noise", "delay"));
  EXPECT_THAT(proposed({"study", "mer"}), ElementsAre("merge"));
  EXPECT_THAT(proposed({"nonsense", "es"}), ElementsAre("estimate"));
}

TEST_F(Completion, Options) {
  EXPECT_THAT(proposed({"estimate", "--cat"}), ElementsAre("--catheter"));
  EXPECT_THAT(proposed({"estimate", "--m"}), UnorderedElementsAre("--method", "--measurement"));
  EXPECT_THAT(proposed({"identify", "noise", "--mo"}), ElementsAre("--moving"));
  EXPECT_THAT(proposed({"identify", "--mo"}), IsEmpty());
  EXPECT_THAT(proposed({"--v"}), ElementsAre("--version"));
}

TEST_F(Completion, Words) {
  EXPECT_THAT(proposed({"estimate", "--method", ""}), UnorderedElementsAre("ekf", "iekf", "iaekf", "ukf"));
  EXPECT_THAT(proposed({"estimate", "--method", "ie"}), ElementsAre("iekf"));
  EXPECT_THAT(proposed({"estimate", "--method", "=", "u"}), ElementsAre("ukf"));  // as bash parts --method=u
  EXPECT_THAT(proposed({"estimate", "--method", "="}), testing::SizeIs(4));
  EXPECT_THAT(proposed({"study", "report", "--pictures", ""}), UnorderedElementsAre("svg", "png"));
  EXPECT_THAT(proposed({"reproduce", "table"}), Contains("table3"));
  EXPECT_THAT(proposed({"estimate", "--reference", ""}), IsEmpty());
}

TEST_F(Completion, Files) {
  EXPECT_THAT(proposed({"estimate", "--catheter", "c."}), ElementsAre("c.toml"));
  EXPECT_THAT(proposed({"estimate", "--catheter", "c.toml", "r."}), ElementsAre("r.csv"));
  EXPECT_THAT(proposed({"estimate", "a"}), Contains("a file.csv"));
  EXPECT_THAT(proposed({"reproduce", "table3", "--out", ""}), ElementsAre("deep"));
  EXPECT_THAT(proposed({"study", "c."}), ElementsAre("c.toml"));
}

TEST_F(Completion, AValueIsNoCommand) {
  EXPECT_THAT(proposed({"study", "--out", "report", "--pic"}), IsEmpty());
  EXPECT_THAT(proposed({"study", "--out", "report", "--sh"}), ElementsAre("--shard"));
  EXPECT_THAT(proposed({"study", "--json", "report", "--pic"}), ElementsAre("--pictures"));
}

TEST_F(Completion, ZshAndFish) {
  for (const char* shell : {"zsh", "fish"}) {
    const test::ProgramRun run = palpate({"completion", shell});
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_THAT(run.out, testing::HasSubstr("iaekf"));
    EXPECT_TRUE(syntax_is_good(shell)) << shell;
  }
}

TEST_F(Completion, UnknownShell) {
  const test::ProgramRun run = palpate({"completion", "tcsh"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, testing::HasSubstr("tcsh"));
  EXPECT_EQ(refusal({"completion", "bash", "--out", ""}), "--out: expected a value, found an empty one");
}

}  // namespace
}  // namespace palpate
