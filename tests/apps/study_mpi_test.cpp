// SPDX-License-Identifier: Apache-2.0
#include <palpate/store/database.hpp>
#include <tests/apps/study_fixture.hpp>

/// `palpate study --mpi`: what MPI plays is what one process plays.
namespace palpate {
namespace {

using ::testing::HasSubstr;

class MpiStudy : public test::KilledStudy {
 protected:
  void SetUp() override {
    KilledStudy::SetUp();
    if (!std::filesystem::exists(std::filesystem::path(PALPATE_BINARY).replace_filename("palpate-study-mpi")))
      GTEST_SKIP() << "built without MPI";
  }
  test::ProgramRun mpirun(const std::string& ranks, const Arguments& more) const {
    Arguments arguments = words(ranks);
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::run_program("/usr/bin/env", arguments, path(""));
  }
  /// On this computer alone, where there may be no ssh; as root, too, as containers have it.
  static Arguments words(const std::string& ranks) {
    return {"OMPI_MCA_plm=isolated",
            "OMPI_ALLOW_RUN_AS_ROOT=1",
            "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
            "mpirun",
            "--oversubscribe",
            "-n",
            ranks,
            PALPATE_BINARY,
            "study",
            "s.toml",
            "--mpi",
            "--json"};
  }
};

TEST_F(MpiStudy, GivesWhatOneProcessGives) {
  write("s.toml", test::kStudyOfUpdates);
  const test::ProgramRun run = mpirun("3", {"--out", "m.study"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto summary = nlohmann::json::parse(run.out, nullptr, false);
  EXPECT_EQ(summary.at("workers"), 2);
  EXPECT_EQ(summary.at("runs_played"), 1000);
  played({"--out", "one.study", "--workers", "1"});
  EXPECT_EQ(hash("m.study"), hash("one.study"));
}

TEST_F(MpiStudy, ARankThatDiesEndsTheJobAndTheSameCommandGoesOn) {
  Arguments words = MpiStudy::words("3");
  words.insert(words.end(), {"--out", "k.study"});
  words.insert(words.begin(), "env");
  test::Background job(path("").string(), {words.begin(), words.end()}, "/usr/bin/env");
  wait_until([&] { return shards_done("k.study") > 5; });
  const std::vector<pid_t> ranks = test::children_of(job.process());
  ASSERT_EQ(ranks.size(), 3U);
  ASSERT_EQ(::kill(ranks[2], SIGKILL), 0);
  EXPECT_NE(job.wait(), 0);
  const nlohmann::json rest = played({"--out", "k.study"});
  EXPECT_GT(rest.at("shards_before"), 5);
  EXPECT_GT(rest.at("shards_played"), 0);
  played({"--out", "whole.study"});
  EXPECT_EQ(hash("k.study"), hash("whole.study"));
}

TEST_F(MpiStudy, BadStudiesEndTheJob) {
  EXPECT_THAT(refusal({"study", "s.toml", "--mpi", "--out", "m.study"}),  // without mpirun
              HasSubstr("--mpi: expected two ranks or more"));
  write("s.toml", "schema = 2\n");
  const test::ProgramRun run = mpirun("3", {"--out", "n.study"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("palpate: s.toml:1: schema = 2: expected 1"));
  EXPECT_EQ(run.err.find("s.toml"), run.err.rfind("s.toml")) << "told once";
  EXPECT_FALSE(std::filesystem::exists(path("n.study")));
}

/// Rank 2 has another file of the same name, as a machine may.
TEST_F(MpiStudy, ARankWithOtherNumbersIsRefused) {
  std::string text = test::read_whole(path("s.toml"));
  write("t.toml", text.replace(text.find("repeats = 600"), 13, "repeats = 601"));
  const std::string program = std::filesystem::path(PALPATE_BINARY).replace_filename("palpate-study-mpi");
  Arguments arguments = words("2");
  arguments.erase(arguments.end() - 5, arguments.end());
  for (const Arguments& rank : {Arguments{program, "s.toml"}, Arguments{":", "-n", "1", program, "t.toml"}}) {
    arguments.insert(arguments.end(), rank.begin(), rank.end());
    arguments.insert(arguments.end(), {"--out", "m.study"});
  }
  const test::ProgramRun run = test::run_program("/usr/bin/env", arguments, path(""));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("--mpi: rank 2: expected the runs of s.toml as rank 0 plays them"));
}

/// Rank 1 cannot make its folder for temporary files.
TEST_F(MpiStudy, ARankThatFailsSaysWhy) {
  const std::string program = std::filesystem::path(PALPATE_BINARY).replace_filename("palpate-study-mpi");
  Arguments arguments = words("2");
  arguments.erase(arguments.end() - 5, arguments.end());
  arguments.insert(arguments.end(), {"/bin/sh", "-c",
                                     "[ $OMPI_COMM_WORLD_RANK = 0 ] || export TMPDIR=s.toml; exec " + program +
                                         " s.toml --out m.study"});
  const test::ProgramRun run = test::run_program("/usr/bin/env", arguments, path(""));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("rank 1: "));
  EXPECT_THAT(run.err, HasSubstr("TMPDIR: expected a folder"));
}

TEST_F(MpiStudy, UnknownWordsAreToldOnce) {
  const test::ProgramRun run = mpirun("3", {"--out", "m.study", "--bogus"});
  EXPECT_EQ(run.exit_code, 2);
  const std::string program = std::filesystem::path(PALPATE_BINARY).replace_filename("palpate-study-mpi");
  Arguments arguments = words("3");
  arguments.erase(arguments.end() - 5, arguments.end());
  arguments.insert(arguments.end(), {program, "s.toml", "--bogus"});
  const test::ProgramRun job = test::run_program("/usr/bin/env", arguments, path(""));
  EXPECT_EQ(job.exit_code, 2);
  EXPECT_THAT(job.err, HasSubstr("palpate: study --mpi: "));
  EXPECT_EQ(job.err.find("bogus"), job.err.rfind("bogus")) << "told once";
}

TEST_F(MpiStudy, AbsentMpiIsSaid) {
  std::filesystem::copy(PALPATE_BINARY, path("palpate"));
  const test::ProgramRun run = test::run_program(path("palpate"), {"study", "s.toml", "--out", "r", "--mpi"}, path(""));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("--mpi: expected a build with MPI: "));
}

}  // namespace
}  // namespace palpate
