// SPDX-License-Identifier: Apache-2.0
#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

/// Typing errors: one line that says what is wrong, one where to read on.
class CommandLine : public test::App {
 protected:
  std::string usage_error(const Arguments& arguments) const {
    const test::ProgramRun run = palpate(arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(test::count_lines(run.err), 2u) << run.err;
    const std::size_t end = run.err.find('\n');
    const bool for_estimate = !arguments.empty() && arguments[0] == "estimate";
    EXPECT_EQ(run.err.substr(end + 1), for_estimate ? "Run palpate estimate --help for what is possible.\n"
                                                    : "Run palpate --help for what is possible.\n");
    return run.err.substr(0, end);
  }
};

TEST_F(CommandLine, HelpShowsAnExample) {
  for (const Arguments& arguments : {Arguments{"--help"}, {"estimate", "--help"}, {"evaluate", "--help"}}) {
    const auto run = palpate(arguments);
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_EQ(run.err, "");
    EXPECT_NE(run.out.find("Example: palpate "), std::string::npos) << run.out;
  }
  EXPECT_NE(palpate({"--help"}).out.find("estimate"), std::string::npos);
  const auto version = palpate({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_TRUE(version.out.starts_with("palpate ")) << version.out;
}

TEST_F(CommandLine, UnknownWordsAreNamedWithTheNearest) {
  EXPECT_EQ(
      usage_error({}),
      "palpate: expected one of the commands estimate, evaluate, export, identify, inspect, record, replay, report, "
      "reproduce, serve, simulate, study");
  EXPECT_EQ(usage_error({"estimat"}),
            "palpate: estimat: expected one of the commands estimate, evaluate, export, identify, inspect, record, "
            "replay, report, reproduce, serve, simulate, study; did you mean estimate?");
  EXPECT_EQ(usage_error({"--foo"}), "palpate: --foo: expected an option of palpate; did you mean --help?");
  EXPECT_EQ(usage_error({"estimate", "--cateter", "c.toml", "r.csv", "--out", "e.csv"}),
            "palpate: --cateter: expected an option of palpate estimate; did you mean --catheter?");
  EXPECT_EQ(usage_error({"estimate", "--catheter", "c.toml", "r.csv", "--out", "e.csv", "--metod=ekf"}),
            "palpate: --metod: expected an option of palpate estimate; did you mean --method?");
  EXPECT_EQ(usage_error({"estimate", "--catheter", "c.toml", "--out", "e.csv"}), "palpate: recording is required");
  EXPECT_EQ(usage_error({"estimate", "--catheter", "c.toml", "r.csv"}), "palpate: --out is required");
  EXPECT_EQ(refusal({"estimate", "--catheter", "c.toml", "r.csv", "s.csv", "--out", "e.csv"}),  // a second recording
            "s.csv: cannot be opened: No such file or directory: expected a readable text file");
}

TEST_F(CommandLine, WrongValues) {
  EXPECT_EQ(estimate_refusal({"--method", "iefk"}), "--method iefk: expected one of ekf, iekf, iaekf, ukf");
  EXPECT_EQ(estimate_refusal({"--measurement", "pose"}),
            "--measurement pose: expected one of poses, tip_and_curvature");
  for (const char* state : {"stiffness", "force,tendon", "force,", ",", "Force"})
    EXPECT_EQ(estimate_refusal({"--state", state}),
              std::string("--state ") + state +
                  ": expected force, to which stiffness and precurvature may be added, as in force,stiffness");
  EXPECT_EQ(estimate_refusal({"--force-model", "walk"}),
            "--force-model walk: expected one of random_walk, constant_velocity, gauss_markov, rhythm");
  EXPECT_EQ(estimate_refusal({"--forecast", "-1"}), "--forecast -1: expected seconds, 0 to 60");
  EXPECT_EQ(estimate_refusal({"--forecast", "0.1", "--smooth"}),
            "--forecast 0.1: expected without --smooth, which knows what comes");
  for (const char* text : {"2", "0-2", "a:b", "0:", ":2", "0:2s", "0:inf", "0:1:2"})
    EXPECT_EQ(estimate_refusal({"--reference", text}),
              std::string("--reference ") + text + ": expected FROM:TO in seconds, as 0:2");
  EXPECT_EQ(estimate_refusal({"--reference", "2:1"}), "--reference 2:1: expected an end after the beginning");
  EXPECT_EQ(estimate_refusal({"--reference", "50:60"}),
            "r.csv: reference 50:60 s: expected an interval with frames; the recording goes from 0 s to 3.975 s");
}

TEST_F(CommandLine, OutputsThatCannotBe) {
  EXPECT_EQ(estimate_refusal({"--plot", "p.pdf"}), "--plot p.pdf: expected a file name that ends in .svg or .png");
  EXPECT_EQ(estimate_refusal({"--plot", "no/p.svg"}), "--plot no/p.svg: expected the folder no to exist");
  EXPECT_EQ(estimate_refusal({"--budget", "no/b.csv"}), "--budget no/b.csv: expected the folder no to exist");
  EXPECT_EQ(estimate_refusal({"--budget", "r.csv"}), "--budget r.csv: expected another file than the recording");
  EXPECT_EQ(estimate_refusal({"--budget", "c.toml"}), "--budget c.toml: expected another file than the catheter file");
  EXPECT_EQ(estimate_refusal({"--budget", "./e.csv"}), "--budget ./e.csv: expected another file than --out");
  EXPECT_EQ(estimate_refusal({"--plot", "p.svg", "--budget", "p.svg"}),
            "--budget p.svg: expected another file than --plot");
  EXPECT_EQ(estimate_refusal({"--budget", "/proc/b.csv"}), "/proc/b.csv: cannot be written: No such file or directory");
  const auto out = [](const char* name) {
    return Arguments{"estimate", "--catheter", "c.toml", "r.csv", "--out", name};
  };
  EXPECT_EQ(refusal(out("no/e.csv")), "--out no/e.csv: expected the folder no to exist");
  EXPECT_EQ(refusal(out("")), "--out: expected the name of a file, found an empty one");
  EXPECT_EQ(refusal(out("./r.csv")), "--out ./r.csv: expected another file than the recording");
  EXPECT_EQ(refusal(out("c.toml")), "--out c.toml: expected another file than the catheter file");
  std::filesystem::create_directory(path("folder"));
  EXPECT_EQ(refusal(out("folder")), "folder: cannot be written: Is a directory");
  EXPECT_EQ(refusal(out("/proc/e.csv")), "/proc/e.csv: cannot be written: No such file or directory");
}

}  // namespace
}  // namespace palpate
