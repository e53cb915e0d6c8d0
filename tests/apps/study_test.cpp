// SPDX-License-Identifier: Apache-2.0
#include <palpate/store/database.hpp>
#include <string>
#include <tests/apps/study_fixture.hpp>

/// `palpate study`, end to end: the same results from any number of workers, after a kill, from an array of jobs.
namespace palpate {
namespace {

using test::KilledStudy;
using test::Study;
using ::testing::HasSubstr;

TEST_F(Study, TheNumberOfWorkersChangesNoByte) {
  for (const char* workers : {"1", "2", "4"}) {
    const nlohmann::json summary = played({"--out", std::string(workers) + ".study", "--workers", workers});
    EXPECT_EQ(summary.at("runs_done"), 1000);
    EXPECT_EQ(summary.at("shards_played"), 20);
    EXPECT_EQ(summary.at("runs_failed"), 0);
    EXPECT_FALSE(std::filesystem::exists(path(std::string(workers) + ".study-wal")));
    EXPECT_FALSE(std::filesystem::exists(path(std::string(workers) + ".study.lock")));
  }
  EXPECT_EQ(hash("1.study"), hash("2.study"));
  EXPECT_EQ(hash("1.study"), hash("4.study"));
  EXPECT_EQ(test::count_lines(test::read_whole(path("1.study.csv"))), 1001U);
}

TEST_F(Study, ArrayJobsMergeIntoTheSame) {
  played({"--out", "all.study"});
  for (const char* i : {"0", "1", "2"}) played({"--out", std::string(i) + ".study", "--shard", std::string(i) + "/3"});
  ASSERT_EQ(palpate({"study", "merge", "2.study", "0.study", "1.study", "--out", "m.study"}).exit_code, 0);
  EXPECT_EQ(hash("m.study"), hash("all.study"));
  ASSERT_EQ(palpate({"study", "merge", "all.study", "1.study", "--out", "m2.study"}).exit_code, 0);
  EXPECT_EQ(hash("m2.study"), hash("all.study"));
  EXPECT_THAT(refusal({"study", "merge", "1.study", "2.study", "--out", "m.study"}),
              HasSubstr("m.study: is there already"));
}

TEST_F(Study, AFileThatContradictsIsNotMerged) {
  played({"--out", "a.study"});
  std::filesystem::copy(path("a.study"), path("b.study"));
  store::Database(path("b.study")).execute("UPDATE run SET rmse_x_N = rmse_x_N + 1e-9 WHERE run = 777");
  EXPECT_THAT(refusal({"study", "merge", "a.study", "b.study", "--out", "m.study"}), HasSubstr("b.study: shard 15: "));
}

/// SQLite has names of its own: in memory, or with options behind them.
TEST_F(Study, EveryNameIsAFile) {
  for (const std::string name : {":memory:", "file:zz.study?mode=memory"}) {
    played({"--out", name, "--shard", "0/20"});
    EXPECT_TRUE(std::filesystem::exists(path(name)));
    ASSERT_EQ(palpate({"study", "merge", name, "--out", "m.study"}).exit_code, 0);
    EXPECT_EQ(hash("m.study"), hash(name));
    std::filesystem::remove(path("m.study"));
  }
}

/// A study that is being played where the merge shall go is in nobody's way, nor is it lost.
TEST_F(Study, AMergeDoesNotReplaceAStudyThatIsPlayed) {
  played({"--out", "a.study"});
  const store::FileLock lock(path("m.study"));
  EXPECT_THAT(refusal({"study", "merge", "a.study", "--out", "m.study"}), HasSubstr("another process is writing it"));
}

/// A path may be no text at all.
TEST_F(Study, JsonOfANameThatIsNoUtf8) {
  played({"--out", "r\xff.study", "--shard", "0/20"});
  EXPECT_EQ(palpate({"study", "merge", "r\xff.study", "--out", "m\xff", "--json"}).exit_code, 0);
}

/// Why a run failed does not depend on where the files are, nor from where they are named.
TEST_F(Study, AFailureIsToldWithoutItsPlace) {
  write_catheter("length_mm = 70.0", "length_mm = 100.0");
  std::string text = test::kStudyOfUpdates;
  text.replace(text.find("[0.1, 0.2]"), 10, "[0.1]");
  write("s.toml", text +
                      "[[vary]]\nname = \"catheter.length_mm\"\nvalues = [100.0, 75.0]\n"
                      "[[vary]]\nname = \"catheter.sensor.tip.arc_length_mm\"\nvalues = [70.0, 90.0]\n");
  ASSERT_EQ(palpate({"study", "s.toml", "--out", "a.study"}).exit_code, 0);
  ASSERT_EQ(palpate({"study", path("s.toml").string(), "--out", "b.study"}).exit_code, 0);
  EXPECT_EQ(hash("a.study"), hash("b.study"));
  EXPECT_THAT(test::read_whole(path("a.study.csv")), HasSubstr("sensor.arc_length_mm = 90"));
  EXPECT_EQ(test::read_whole(path("a.study.csv")).find("c.toml"), std::string::npos);
}

TEST_F(Study, WhatIsDoneIsNotPlayedAgain) {
  played({"--out", "r.study", "--shard", "0/2"});
  const nlohmann::json rest = played({"--out", "r.study"});
  EXPECT_EQ(rest.at("shards_before"), 10);
  EXPECT_EQ(rest.at("shards_played"), 10);
  EXPECT_EQ(played({"--out", "r.study"}).at("shards_played"), 0);
  played({"--out", "all.study"});
  EXPECT_EQ(hash("r.study"), hash("all.study"));
}

TEST_F(KilledStudy, AKilledWorkerLosesAtMostItsShard) {
  test::Background study(path("").string(),
                         {"palpate", "study", "s.toml", "--out", "k.study", "--workers", "2", "--json"});
  wait_until([&] { return shards_done("k.study") > 5; });
  const std::vector<pid_t> workers = test::children_of(study.process());
  ASSERT_EQ(workers.size(), 2U);
  ASSERT_EQ(::kill(workers[0], SIGKILL), 0);
  ASSERT_EQ(study.wait(), 0);
  const auto summary = nlohmann::json::parse(test::read_whole(path("bg.txt")), nullptr, false);
  EXPECT_EQ(summary.at("workers_lost"), 1) << test::read_whole(path("bg.err"));
  EXPECT_THAT(test::read_whole(path("bg.err")), HasSubstr("its worker was lost: killed by signal 9"));
  played({"--out", "whole.study"});
  EXPECT_EQ(hash("k.study"), hash("whole.study"));
}

TEST_F(KilledStudy, AKilledStudyGoesOn) {
  {
    test::Background study(path("").string(), {"palpate", "study", "s.toml", "--out", "k.study", "--workers", "2"});
    wait_until([&] { return shards_done("k.study") > 5; });
    const test::ProgramRun second = palpate({"study", "s.toml", "--out", "k.study"});
    EXPECT_EQ(second.exit_code, 2);
    EXPECT_EQ(second.out, "");
    EXPECT_THAT(second.err, HasSubstr("k.study: another process is writing it"));
    study.kill(SIGKILL);
  }
  const nlohmann::json rest = played({"--out", "k.study"});
  EXPECT_GT(rest.at("shards_before"), 5);
  EXPECT_GT(rest.at("shards_played"), 0);
  played({"--out", "whole.study"});
  EXPECT_EQ(hash("k.study"), hash("whole.study"));
}

/// What the parent keeps of a run is in the file alone: 1 000 and 12 000 runs need the same memory.
TEST_F(Study, MemoryDoesNotGrowWithTheRuns) {
  std::string text = test::read_whole(path("s.toml"));
  write("l.toml", text.replace(text.find("repeats = 100"), 13, "repeats = 1200"));
  const double small = palpate({"study", "s.toml", "--out", "s.study"}).peak_memory_MB;
  const double large = palpate({"study", "l.toml", "--out", "l.study"}).peak_memory_MB;
  EXPECT_LT(large, small + 2.0);
  EXPECT_GT(small, 1.0);
}

/// The frame has the noise and the prior the spread that the filter is told, but for the ball: wide enough a prior, and
/// the error squared over the covariance is chi-square with 3 degrees: its mean over 1000 is 3 within 4 sqrt(6 / 1000).
TEST_F(Study, TheCovarianceOfAnUpdateIsTrue) {
  played({"--out", "r.study"});
  const store::Database database = study::open_results(path("r.study"));
  store::Statement row = database.prepare("SELECT avg(nees), avg(inside_95_x), avg(updated), count(*) FROM run");
  ASSERT_TRUE(row.step());
  EXPECT_NEAR(row.number(0), 3.0, 0.31);
  EXPECT_NEAR(row.number(1), 0.95, 0.028);
  EXPECT_EQ(row.number(2), 1.0);
  EXPECT_EQ(row.integer(3), 1000);
}

/// Every number of the export is the one that is stored, to the last bit.
TEST_F(Study, TheExportRoundsNothing) {
  played({"--out", "r.study"});
  ASSERT_EQ(palpate({"study", "export", "r.study", "--out", "r.csv"}).exit_code, 0);
  const test::EstimateTable rows = table("r.csv");
  const store::Database database = study::open_results(path("r.study"));
  store::Statement row = database.prepare("SELECT * FROM run ORDER BY shard, run");
  for (const auto& line : rows) {
    ASSERT_TRUE(row.step());
    for (int c = study::kLeadingColumns; c < row.columns(); ++c)
      ASSERT_EQ(std::stod(line.at(row.column_name(c))), row.number(c)) << row.column_name(c);
  }
  EXPECT_FALSE(row.step());
}

TEST_F(Study, AScenarioIsPlayedAsTheOtherCommandsPlayIt) {
  const std::string folder = PALPATE_SOURCE_DIR "/examples/scenarios/";
  write("s.toml", "schema = 1\n[study]\nscenario = \"" + folder +
                      "straight_shaft.toml\"\nseed = 3\n"
                      "[[vary]]\nname = \"scenario.duration_s\"\nvalues = [3.0]\n"
                      "[[vary]]\nname = \"scenario.tracker.noise_mm\"\nvalues = [0.1, 0.5]\n");
  played({"--out", "r.study"});
  ASSERT_EQ(palpate({"study", "export", "r.study", "--out", "r.csv"}).exit_code, 0);
  const test::EstimateTable rows = table("r.csv");
  ASSERT_EQ(rows.size(), 2U);
  ASSERT_EQ(palpate({"study", "export", "r.study"}).out, test::read_whole(path("r.csv")));
  std::string scenario = test::read_whole(folder + "straight_shaft.toml") + "[tracker]\nnoise_mm = 0.5\n";
  scenario.replace(scenario.find("catheters/"), 10, folder + "catheters/");
  write("one.toml", scenario);
  ASSERT_EQ(
      palpate({"simulate", "one.toml", "--out", "one", "--duration", "3", "--seed", rows[1].at("seed")}).exit_code, 0);
  ASSERT_EQ(palpate({"estimate", "--catheter", "one.catheter.toml", "one.tracker.csv", "--out", "one.csv"}).exit_code,
            0);
  const test::ProgramRun judged = palpate({"evaluate", "--estimate", "one.csv", "--truth", "one.force.csv", "--json"});
  ASSERT_EQ(judged.exit_code, 0) << judged.err;
  const auto rmse = nlohmann::json::parse(judged.out, nullptr, false).at("rmse_N");
  for (const std::string axis : {"x", "y", "z"})  // the files between them round to nanometres and nanonewtons
    EXPECT_NEAR(test::number(rows[1], "rmse_" + axis + "_N"), rmse.at(axis).get<double>(), 1e-5) << axis;
}

/// A full folder for temporary files is not a property of the run: nothing of it is kept.
TEST_F(Study, WhatTheMachineLacksIsNoFailedRun) {
  write("s.toml", "schema = 1\n[study]\nscenario = \"" PALPATE_SOURCE_DIR
                  "/examples/scenarios/straight_shaft.toml\"\nshard_runs = 1\n"
                  "[[vary]]\nname = \"scenario.duration_s\"\nvalues = [1.5, 2.0]\n");
  const std::string temporary = path("tmp").string();
  std::filesystem::create_directory(temporary);
  const std::string command =
      "( timeout 10 sh -c 'until [ -e r.study-wal ]; do :; done'; rm -rf tmp/* ) & TMPDIR=" + temporary +
      " " PALPATE_BINARY " study s.toml --out r.study --workers 1";
  test::run_program("/bin/bash", {"-c", command}, path(""));
  EXPECT_EQ(study::read_head(study::open_results(path("r.study"))).runs_failed, 0U);
  EXPECT_EQ(played({"--out", "r.study"}).at("runs_failed"), 0);
}

TEST_F(Study, RunsThatCannotBePlayedAreToldAndCounted) {
  const std::string folder = PALPATE_SOURCE_DIR "/examples/scenarios/";
  write("s.toml", "schema = 1\n[study]\nscenario = \"" + folder +
                      "straight_shaft.toml\"\n"
                      "[[vary]]\nname = \"scenario.duration_s\"\nvalues = [0.5, 2.0]\n");
  const test::ProgramRun run = palpate({"study", "s.toml", "--out", "r.study"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("palpate: warning: 1 of 2 runs failed"));
  EXPECT_THAT(palpate({"study", "export", "r.study"}).out, HasSubstr("no frame to judge"));
}

/// Names that Markdown, or a file, would take for something else.
TEST_F(Study, TheReportSpellsNames) {
  write("s.toml",
        "schema = 1\n[study]\nname = \"a\\n# b\"\nmodel = \"single_update\"\ncatheter = \"c2.toml\"\n"
        "[[vary]]\nname = \"catheter.sensor.t-1.noise_mm\"\nvalues = [0.1, 0.2]\n"
        "[[vary]]\nname = \"catheter.sensor.t_1.noise_mm\"\nvalues = [0.1, 0.2]\n"
        "[[vary]]\nname = \"catheter.name\"\nvalues = [\"a|b\", \"c\\nd\"]\n");
  std::string catheter = test::read_whole(path("c.toml"));
  for (const auto& [name, other] : {std::pair{"\"tip\"", "\"t-1\""}, std::pair{"\"shaft\"", "\"t_1\""}}) {
    const std::size_t at = catheter.find(name);
    ASSERT_NE(at, std::string::npos) << catheter;
    catheter.replace(at, std::string(name).size(), other);
  }
  write("c2.toml", catheter);
  ASSERT_EQ(palpate({"study", "s.toml", "--out", "r.study"}).exit_code, 0);
  ASSERT_EQ(palpate({"study", "report", "r.study", "--out", "r (1).md"}).exit_code, 0);
  const std::string text = test::read_whole(path("r (1).md"));
  EXPECT_THAT(text, HasSubstr("](<r (1)-catheter_sensor_t_1_noise_mm.svg>)"));
  EXPECT_THAT(text, HasSubstr("](<r (1)-catheter_sensor_t_1_noise_mm-2.svg>)"));
  EXPECT_TRUE(std::filesystem::exists(path("r (1)-catheter_sensor_t_1_noise_mm-2.svg")));
  EXPECT_THAT(text, HasSubstr("| a\\|b | 4 |"));
  EXPECT_THAT(text, HasSubstr("| c d | 4 |"));
  EXPECT_THAT(text, HasSubstr("# a # b\n"));
  EXPECT_THAT(refusal({"study", "report", "r.study", "--out", "/dev/null"}), HasSubstr("expected a file"));
}

TEST_F(Study, TheReportHasATableAndAPictureAParameter) {
  played({"--out", "r.study"});
  const test::ProgramRun run = palpate({"study", "report", "r.study", "--out", "r.md"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string text = test::read_whole(path("r.md"));
  EXPECT_THAT(text, HasSubstr("## Against update.ball_N"));
  EXPECT_THAT(text, HasSubstr("| 0.1 | 500 |"));
  EXPECT_THAT(text, HasSubstr("| 54 .. 60 |"));
  EXPECT_THAT(test::read_whole(path("r-update_ball_N.svg")), HasSubstr("</svg>"));
}

}  // namespace
}  // namespace palpate
