// SPDX-License-Identifier: Apache-2.0
#include <palpate/store/database.hpp>
#include <tests/apps/study_fixture.hpp>

/// Studies that cannot be, and files that are not what they should be: exit code 2, one line, nothing lost.
namespace palpate {
namespace {

using ::testing::HasSubstr;

class BadStudy : public test::Study {};

TEST_F(BadStudy, SettingsAndCounts) {
  EXPECT_THAT(
      refused("update.ball_N", "update.bal_N"),
      HasSubstr("bad.toml:12: vary.name = \"update.bal_N\": expected a known setting; did you mean update.ball_N?"));
  EXPECT_THAT(refused("update.ball_N", "filter.methud"), HasSubstr("did you mean filter.method?"));
  EXPECT_THAT(refused("update.ball_N", "catheter.estimater.method"),
              HasSubstr("did you mean catheter.estimator.method?"));
  EXPECT_THAT(refused("update.ball_N", "catheter.sensor.tipp.noise_mm"), HasSubstr("did you mean tip?"));
  EXPECT_THAT(refused("update.ball_N", "filtre.method"), HasSubstr("did you mean filter?"));
  EXPECT_THAT(refused("[0.1, 0.2]", "[0.1, -0.2]"), HasSubstr("with -0.2: update.ball_N = -0.2: expected the radius"));
  EXPECT_THAT(refused("[0.1, 0.2]", "[]"), HasSubstr("vary.values = []: expected at least one value"));
  EXPECT_THAT(refused("[0.1, 0.2]", "[0.1, 0.1]"), HasSubstr("here 0.1 stands twice"));
  EXPECT_THAT(refused("[0.0, 60.0]", "[60.0, 0.0]"), HasSubstr("expected [from, to] with to above from"));
  EXPECT_THAT(refused("schema = 1\n", "schema = 1\nupdate = 3\n"), HasSubstr("update = 3: expected a table [update]"));
  EXPECT_THAT(refused("\"update.ball_N\"", "\"Catheter.precurvature_per_m[0]\""),
              HasSubstr("expected a parameter that no other [[vary]] has, in any case"));
  EXPECT_THAT(refused("repeats = 100\nshard_runs = 50", "repeats = 10000000\nshard_runs = 1"),
              HasSubstr("expected at most 1e7 shards in all, not 1e+08"));
  EXPECT_THAT(refused("samples = 5\n", ""),
              HasSubstr("study.samples = (absent): expected points of the Latin hypercube"));
  EXPECT_THAT(refused("repeats = 100", "repeats = 1000000000"), HasSubstr("expected at most 1e9 runs in all"));
  EXPECT_THAT(refused("\"c.toml\"", "\"d.toml\""), HasSubstr("study.catheter = \"d.toml\": expected a file"));
  EXPECT_THAT(refused("repeats = 100", "repeats = 0"),
              HasSubstr("bad.toml:6: study.repeats = 0: expected a whole number, 1..1e9"));
  EXPECT_THAT(refused("repeats = 100", "repeats = 2.5"), HasSubstr("study.repeats = 2.5: expected a whole number"));
  EXPECT_THAT(refused("repeats = 100", "repeats = \"many\""), HasSubstr("study.repeats = \"many\": expected"));
  EXPECT_THAT(refused("repeats = 100", "repeats = = 3"), HasSubstr("bad.toml:6: "));
  EXPECT_THAT(refused("repeats = 100", "repeat = 100"), HasSubstr("did you mean repeats?"));
}

/// Two names of one number: the one that is put last would hide the other, and the report would not tell.
TEST_F(BadStudy, OneSettingHasOneName) {
  const std::string also_bend = "\"catheter.precurvature_per_m\"\nvalues = [[1.0, 0.0, 0.0]]";
  EXPECT_THAT(refused("\"update.ball_N\"\nvalues = [0.1, 0.2]", also_bend),
              HasSubstr("expected a setting that catheter.precurvature_per_m[0] does not set, too"));
  EXPECT_THAT(refused("\"update.ball_N\"\nvalues = [0.1, 0.2]",
                      "\"filter.max_iterations\"\nvalues = [5, 10]\n[[vary]]\n"
                      "name = \"catheter.estimator.max_iterations\"\nvalues = [5, 10]"),
              HasSubstr("expected a setting that filter.max_iterations does not set, too"));
  EXPECT_THAT(refused("update.ball_N", "catheter.catheter.length_mm"), HasSubstr("expected scenario.[TABLE.]KEY"));
  EXPECT_THAT(refused("[0.1, 0.2]", "[0.1, \"0.1\"]"), HasSubstr("expected values of one kind"));
  EXPECT_THAT(refused("[0.1, 0.2]", "[0.0, -0.0]"), HasSubstr("expected values that differ"));
  EXPECT_THAT(refused("[0.1, 0.2]", "[0.1, nan]"), HasSubstr("expected finite numbers"));
}

TEST_F(BadStudy, Outputs) {
  EXPECT_THAT(refusal({"study", "s.toml", "--out", "no/r.study"}), HasSubstr("expected the folder no to exist"));
  EXPECT_THAT(refusal({"study", "s.toml", "--out", "/proc/r.study"}), HasSubstr("/proc/r.study: cannot be written: "));
  EXPECT_THAT(refusal({"study", "s.toml"}), HasSubstr("--out"));
  EXPECT_THAT(refusal({"study", "s.toml", "--out", "s.toml"}), HasSubstr("expected another file than the study"));
  EXPECT_THAT(refusal({"study", "s.toml", "--out", "r.study", "--shard", "3/3"}),
              HasSubstr("--shard 3/3: expected i/n with i from 0"));
  EXPECT_THAT(refusal({"study", "s.toml", "--out", "r.csv"}),
              HasSubstr("r.csv: cannot be used: file is not a database"));
  EXPECT_THAT(refusal({"study", "report", "r.csv"}), HasSubstr("r.csv: "));
}

TEST_F(BadStudy, FilesThatAreNoResultsAreKept) {
  store::Database(path("f.db")).execute("CREATE TABLE t (i)");
  EXPECT_THAT(refusal({"study", "s.toml", "--out", "f.db"}), HasSubstr("f.db: is a database of another program"));
  EXPECT_THAT(refusal({"study", "export", "f.db", "--out", "f.csv"}), HasSubstr("f.db: expected results of palpate"));
  played({"--out", "r.study"});
  std::filesystem::copy(path("r.study"), path("t.study"));
  std::filesystem::resize_file(path("t.study"), std::filesystem::file_size(path("t.study")) / 2);
  for (const Arguments& arguments :
       {Arguments{"study", "s.toml", "--out", "t.study"}, Arguments{"study", "export", "t.study", "--out", "t.csv"},
        Arguments{"study", "report", "t.study", "--out", "t.md"},
        Arguments{"study", "merge", "r.study", "t.study", "--out", "m.study"}})
    EXPECT_THAT(refusal(arguments), HasSubstr("t.study: ")) << arguments[1];
}

/// A run that is missing, or one too many, is not passed over.
TEST_F(BadStudy, ShardsThatAreNotWholeAreTold) {
  played({"--out", "r.study"});
  store::Database(path("r.study")).execute("DELETE FROM run WHERE run = 777");
  for (const Arguments& arguments :
       {Arguments{"study", "s.toml", "--out", "r.study"}, Arguments{"study", "export", "r.study", "--out", "t.csv"},
        Arguments{"study", "report", "r.study", "--out", "t.md"},
        Arguments{"study", "merge", "r.study", "--out", "m.study"}})
    EXPECT_THAT(refusal(arguments), HasSubstr("r.study: holds 999 runs: expected 1000")) << arguments[1];
}

/// Another build that gives other numbers: its shards do not belong into this file.
TEST_F(BadStudy, ResultsOfAnotherProgramAreNotMixed) {
  played({"--out", "a.study", "--shard", "0/2"});
  played({"--out", "b.study", "--shard", "1/2"});
  store::Database(path("b.study")).execute("UPDATE study SET fingerprint = 'of another build'");
  EXPECT_THAT(refusal({"study", "s.toml", "--out", "b.study"}),
              HasSubstr("b.study: was begun by another build of the program"));
  EXPECT_THAT(refusal({"study", "merge", "a.study", "b.study", "--out", "m.study"}),
              HasSubstr("b.study: is of another build of the program than a.study"));
}

/// The same processor without two of its instruction sets: the mathematical library takes other code.
TEST_F(BadStudy, AnotherMathematicalLibraryIsFound) {
  if (test::read_whole("/proc/cpuinfo").find(" fma ") == std::string::npos) GTEST_SKIP() << "no other code to take";
  played({"--out", "a.study", "--shard", "0/2"});
  const test::ProgramRun run = test::run_program(
      "/usr/bin/env",
      {"GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA", PALPATE_BINARY, "study", "s.toml", "--out", "a.study"}, path(""));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("a.study: was begun by another build of the program, or on another machine"));
}

/// Where nothing is missing there is nothing that could be mixed.
TEST_F(BadStudy, ACompleteStudyIsNotPlayedForItsFingerprint) {
  played({"--out", "a.study"});
  store::Database(path("a.study")).execute("UPDATE study SET fingerprint = 'of another build'");
  EXPECT_EQ(played({"--out", "a.study"}).at("workers"), 0);
}

TEST_F(BadStudy, ShardsOfAnotherPlanAreTold) {
  played({"--out", "r.study"});
  store::Database(path("r.study")).execute("UPDATE shard SET shard_id = 'x' WHERE shard = 3");
  EXPECT_THAT(refusal({"study", "s.toml", "--out", "r.study"}), HasSubstr("r.study: shard 3: expected one of the 20"));
  played({"--out", "q.study", "--shard", "0/20"});
  store::Database(path("q.study"))
      .execute("PRAGMA foreign_keys = OFF; UPDATE shard SET shard = 77; UPDATE run SET shard = 77");
  EXPECT_THAT(refusal({"study", "s.toml", "--out", "q.study"}), HasSubstr("q.study: shard 77: expected one of the 20"));
}

TEST_F(BadStudy, WorkersThatCannotBeMadeLeaveNothing) {
  std::filesystem::create_directory(path("tmp"));
  const std::string command =
      "ulimit -n 40; TMPDIR=tmp exec " PALPATE_BINARY " study s.toml --out r.study --workers 100";
  const test::ProgramRun run = test::run_program("/bin/bash", {"-c", command}, path(""));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("no worker can be started: Too many open files"));
  EXPECT_TRUE(std::filesystem::is_empty(path("tmp")));
}

TEST_F(BadStudy, TemporaryFolderThatIsAFile) {
  write("file", "");
  const test::ProgramRun run = test::run_program(
      "/usr/bin/env", {"TMPDIR=file", PALPATE_BINARY, "study", "s.toml", "--out", "r.study"}, path(""));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("TMPDIR: expected a folder for temporary files: Not a directory"));
}

/// A full disk, by way of the largest file that a process may write: what was stored before stays, and is gone on with.
TEST_F(BadStudy, AFullDiskLosesNothing) {
  const std::string command = "trap '' XFSZ; ulimit -f 100; exec " PALPATE_BINARY " study s.toml --out r.study";
  const test::ProgramRun run = test::run_program("/bin/bash", {"-c", command}, path(""));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("r.study: cannot be "));
  EXPECT_EQ(test::count_lines(run.err), 1U) << run.err;
  const nlohmann::json rest = played({"--out", "r.study"});
  EXPECT_EQ(rest.at("runs_done"), 1000);
  EXPECT_GT(rest.at("shards_before"), 0);
  played({"--out", "whole.study"});
  EXPECT_EQ(hash("r.study"), hash("whole.study"));
}

TEST_F(BadStudy, ResultsOfAnotherStudyAreKept) {
  played({"--out", "r.study"});
  std::string text = test::read_whole(path("s.toml"));
  write("t.toml", text.replace(text.find("repeats = 100"), 13, "repeats = 101"));
  EXPECT_THAT(refusal({"study", "t.toml", "--out", "r.study"}), HasSubstr("r.study: holds the study \"s\", plan "));
}

}  // namespace
}  // namespace palpate
