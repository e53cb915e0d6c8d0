// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <palpate/recording/force_csv.hpp>
#include <tests/apps/app_fixture.hpp>

/// `palpate simulate`, end to end: the shipped scenarios played and estimated, and what it refuses.
namespace palpate {
namespace {

using ::testing::HasSubstr;

const std::string kScenarios = PALPATE_SOURCE_DIR "/examples/scenarios/";

class Simulate : public test::App {
 protected:
  test::ProgramRun simulate(const std::string& scenario, const Arguments& more = {}) const {
    Arguments arguments{"simulate", scenario, "--out", "run"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return palpate(arguments);
  }
  nlohmann::json json(const std::string& scenario, Arguments more = {}) const {
    more.push_back("--json");
    const test::ProgramRun run = simulate(scenario, more);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out, nullptr, false);
  }
  /// Of a scenario with one part of a shipped one replaced.
  std::string refused(const std::string& name, const std::string& part, const std::string& by,
                      const Arguments& more = {}) const {
    std::string text = test::read_whole(kScenarios + name + ".toml");
    const std::size_t at = text.find(part);
    EXPECT_NE(at, std::string::npos) << part;
    text.replace(at, part.size(), by);
    for (std::size_t c; (c = text.find("\"catheters/")) != std::string::npos;) text.replace(c, 1, "\"" + kScenarios);
    write("bad.toml", text);
    Arguments arguments{"simulate", "bad.toml", "--out", "run"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return refusal(arguments);
  }
};

struct Shipped {
  const char* name;
  bool tendon;
};

class ShippedScenarios : public Simulate, public ::testing::WithParamInterface<Shipped> {};

/// Six seconds of each: enough to touch. The estimate holds every frame, and most of them are used.
TEST_P(ShippedScenarios, ArePlayedAndEstimated) {
  const nlohmann::json played = json(kScenarios + GetParam().name + ".toml", {"--duration", "6"});
  const auto frames = played.at("frames").get<std::size_t>();
  EXPECT_GE(frames, std::string(GetParam().name) == "experiment_2b" ? 20U : 220U);
  EXPECT_GT(played.at("largest_force_N").get<double>(), std::string(GetParam().name) == "steering" ? -1.0 : 0.005);
  EXPECT_LT(played.at("largest_force_N").get<double>(), 0.4);
  EXPECT_EQ(played.at("instabilities"), 0) << played.at("events");
  Arguments arguments{"estimate", "--json", "--catheter", "run.catheter.toml", "run.tracker.csv", "--out", "e.csv"};
  if (GetParam().tendon) arguments.insert(arguments.end(), {"--tendon", "run.tendon.csv"});
  EXPECT_EQ(std::filesystem::exists(path("run.tendon.csv")), GetParam().tendon);
  const test::ProgramRun run = palpate(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const nlohmann::json estimated = nlohmann::json::parse(run.out, nullptr, false);
  EXPECT_EQ(estimated.at("frames"), frames);
  EXPECT_GE(estimated.at("frames_by_status").at("UPDATED").get<double>(), 0.9 * static_cast<double>(frames)) << run.out;
  EXPECT_EQ(read_force_csv(path("run.force.csv")).times_s.size(), frames);
}

constexpr Shipped kShipped[] = {
    {"paper_figure3", false},  {"experiment_1a", false},      {"experiment_1b", false},  {"experiment_2a", false},
    {"experiment_2b", false},  {"straight_shaft", false},     {"beating_heart", false},  {"atrial_fibrillation", false},
    {"contact_on_off", false}, {"wrong_precurvature", false}, {"biased_tracker", false}, {"stiffness_drift", true},
    {"steering", true},        {"bad_tracker", false}};

INSTANTIATE_TEST_SUITE_P(All, ShippedScenarios, ::testing::ValuesIn(kShipped),
                         [](const auto& shipped) { return std::string(shipped.param.name); });

TEST_F(Simulate, EveryShippedScenarioIsTested) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kScenarios))
    count += entry.path().extension() == ".toml" ? 1 : 0;
  EXPECT_EQ(count, std::size(kShipped));
}

TEST_F(Simulate, SameSeedSameFilesAnotherSeedOthers) {
  const std::string scenario = kScenarios + "atrial_fibrillation.toml";
  const auto tracker = [&](const Arguments& more) {
    EXPECT_EQ(simulate(scenario, more).exit_code, 0);
    return test::read_whole(path("run.tracker.csv"));
  };
  const std::string first = tracker({"--duration", "3"});
  EXPECT_EQ(tracker({"--duration", "3"}), first);
  EXPECT_NE(tracker({"--duration", "3", "--seed", "2"}), first);
}

TEST_F(Simulate, TheDriftIsWrittenAndThePictureDrawn) {
  const nlohmann::json played =
      json(kScenarios + "stiffness_drift.toml", {"--rate", "1", "--plot", "force.svg", "--duration", "60"});
  EXPECT_THAT(test::read_whole(path("force.svg")), HasSubstr("</svg>"));
  const test::EstimateTable rows = table("run.stiffness.csv");
  ASSERT_EQ(rows.size(), 60U);
  EXPECT_NEAR(test::number(rows[0], "EI1_Nm2"), 0.2612e-3, 1e-9);
  EXPECT_NEAR(test::number(rows[40], "GJ_Nm2"), 0.1645e-3 * (1.0 - 0.15 * 40.0 / 60.0), 1e-10);
  EXPECT_THAT(played.at("estimate_command").get<std::string>(), HasSubstr("--tendon run.tendon.csv"));
}

/// Without noise the estimate is the truth, but for the filter's lag and the micrometres of the file.
TEST_F(Simulate, NoiseFreeIsExact) {
  write("s.toml", "schema = 1\n[scenario]\ncatheter = \"" + kScenarios +
                      "catheters/ablation_bent_25.toml\"\nduration_s = 3\n[load]\nkind = \"force\"\n"
                      "force_tip_N = [0.02, 0.03, -0.05]\n");
  ASSERT_EQ(simulate("s.toml", {"--noise-free"}).exit_code, 0);
  const test::ProgramRun run =
      palpate({"estimate", "--json", "--catheter", "run.catheter.toml", "run.tracker.csv", "--out", "e.csv"});
  const auto last = nlohmann::json::parse(run.out, nullptr, false).at("last").at("force_tip_N");
  EXPECT_NEAR(last[0].get<double>(), 0.02, 2e-5);
  EXPECT_NEAR(last[1].get<double>(), 0.03, 1e-4);
  EXPECT_NEAR(last[2].get<double>(), -0.05, 1e-4);
}

TEST_F(Simulate, BadScenariosAreRefused) {
  EXPECT_THAT(refused("beating_heart", "gap_mm", "gab_mm"),
              HasSubstr("bad.toml:12: load.gab_mm = 1: expected a known key; did you mean gap_mm?"));
  EXPECT_THAT(refused("beating_heart", "\"wall\"", "\"floor\""),
              HasSubstr("load.kind = \"floor\": expected one of 'force', 'pulley', 'wall'"));
  EXPECT_THAT(refused("experiment_1a", "mass_g = 13.03", "mass_g = -13.03"),
              HasSubstr("load.mass_g = -13.03: expected a mass in g, more than 0"));
  EXPECT_THAT(refused("experiment_2a", "[2, 3], [6, 3]", "[6, 3], [2, 3]"),
              HasSubstr("expected times that rise, here 2 s after 6 s"));
  EXPECT_THAT(refused("steering", "ablation_steered", "ablation_lost"),
              HasSubstr("scenario.catheter = \"" + kScenarios.substr(0, 5)));
  EXPECT_THAT(refused("steering", "[0.0, -45.0, 0.0]", "[0.0, 5.0, 0.0]"),
              HasSubstr("expected a wall that starts clear of it"));
  EXPECT_THAT(refusal({"simulate", "none.toml", "--out", "run"}), HasSubstr("none.toml: "));
  EXPECT_THAT(refusal({"simulate", kScenarios + "steering.toml", "--out", "run", "--duration", "-1"}),
              HasSubstr("--duration -1: expected 0.001 to 86400"));
  EXPECT_THAT(refusal({"simulate", kScenarios + "steering.toml", "--out", "no/run"}), HasSubstr("no"));
}

TEST_F(Simulate, SeedsAndEmptyValuesAreRefused) {
  const auto refused_with = [&](const std::string& flag, const std::string& value) {
    return refusal({"simulate", kScenarios + "steering.toml", "--out", "run", flag, value});
  };
  for (const char* seed : {"-1", "1.5", "x", "9007199254740993", "99999999999999999999999"})
    EXPECT_THAT(refused_with("--seed", seed), HasSubstr(std::string("--seed ") + seed + ": expected a whole number"));
  for (const char* flag : {"--seed", "--duration", "--rate", "--plot"})
    EXPECT_THAT(refused_with(flag, ""), HasSubstr(std::string(flag) + ": expected a value, found an empty one"));
  EXPECT_EQ(json(kScenarios + "experiment_1a.toml", {"--seed", "9007199254740992", "--duration", "1"}).at("seed"),
            9007199254740992U);
}

TEST_F(Simulate, NoOutputGoesOverTheScenariosCatheter) {
  write("mine.catheter.toml", test::read_whole(kScenarios + "catheters/ablation_bent_25.toml"));
  write("s.toml", "schema = 1\n[scenario]\ncatheter = \"mine.catheter.toml\"\nduration_s = 1\n");
  EXPECT_THAT(refusal({"simulate", "s.toml", "--out", "mine"}),
              HasSubstr("--out mine.catheter.toml: expected another file than the scenario's catheter file"));
  EXPECT_EQ(simulate("s.toml").exit_code, 0);
}

TEST_F(Simulate, ANameThatIsOnlyAFolderIsRefused) {
  for (const char* name : {".", "..", "./.", "some/"})
    EXPECT_THAT(refusal({"simulate", kScenarios + "steering.toml", "--out", name}), HasSubstr("expected a name, to"));
}

/// Each by what the user must change: the flag, the file's duration, the share of frames that are lost.
TEST_F(Simulate, NoFramesOrTooManyAreRefused) {
  EXPECT_THAT(refused("experiment_1a", "duration_s = 30.0", "duration_s = 0.01"),
              HasSubstr("bad.toml: scenario.duration_s = 0.01: expected long enough for a frame at 40 Hz"));
  EXPECT_THAT(refused("experiment_1a", "x", "x", {"--duration", "0.01"}),
              HasSubstr("--duration 0.01: expected long enough for a frame at 40 Hz"));
  EXPECT_THAT(refused("experiment_1a", "[load]", "[tracker]\ndropped_percent = 99\n[load]", {"--duration", "0.1"}),
              HasSubstr("tracker.dropped_percent = 99: expected a frame that is left"));
  EXPECT_THAT(refused("experiment_1a", "duration_s = 30.0", "duration_s = 86400", {"--rate", "10000"}),
              HasSubstr("bad.toml: duration_s 86400 at rate_hz 10000: frames = 864000000: expected at most 1000000"));
}

/// At zero the map's bend holds, which need not be the catheter's own.
TEST_F(Simulate, AKnobThatRestsAtZeroIsAKnob) {
  std::string text = test::read_whole(kScenarios + "catheters/ablation_steered.toml");
  const std::string own = "precurvature_per_m = [5.0";
  text.replace(text.find(own), own.size(), "precurvature_per_m = [9.0");
  write("k.toml", text);
  write("s.toml",
        "schema = 1\n[scenario]\ncatheter = \"k.toml\"\nduration_s = 3\n[handle]\nknob_rad = 0\n[load]\n"
        "kind = \"force\"\nforce_tip_N = [0.01, 0.02, 0.0]\n");
  ASSERT_EQ(simulate("s.toml", {"--noise-free"}).exit_code, 0);
  const test::ProgramRun run = palpate({"estimate", "--json", "--catheter", "run.catheter.toml", "run.tracker.csv",
                                        "--tendon", "run.tendon.csv", "--out", "e.csv"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto last = nlohmann::json::parse(run.out, nullptr, false).at("last").at("force_tip_N");
  EXPECT_NEAR(last[0].get<double>(), 0.01, 1e-3);
  EXPECT_NEAR(last[1].get<double>(), 0.02, 2e-3);
}

TEST_F(Simulate, WhatFailsWithoutTheLoadNamesTheFile) {
  std::string text = test::read_whole(kScenarios + "catheters/ablation_bent_25.toml");
  text.replace(
      text.find("[base]"), 6,
      "weight_N_per_m = 100\n[tendon]\nmodel = \"end_moment\"\n[gravity]\ndirection_in_base = [0, 1, 0]\n[base]");
  write("heavy.toml", text);
  write("s.toml",
        "schema = 1\n[scenario]\ncatheter = \"heavy.toml\"\n[handle]\nmoment_1_Nm = 10\n[load]\nkind = \"wall\"\n"
        "gap_mm = 1\nstiffness_N_per_m = 100\n");
  EXPECT_THAT(refusal({"simulate", "s.toml", "--out", "run"}), HasSubstr("s.toml: without [load]: catheter.weight"));
}

TEST_F(Simulate, AScenariosNameDoesNotSpeakToTheTerminal) {
  write("s.toml", "schema = 1\n[scenario]\nname = \"a\\n\\u001b[31mb\"\ncatheter = \"" + kScenarios +
                      "catheters/ablation_bent_25.toml\"\nduration_s = 1\n");
  EXPECT_THAT(simulate("s.toml").out, ::testing::StartsWith("a??[31mb: 40 frames"));
}

/// A straight shaft under a dead load that pushes along it buckles at Euler's load, pi^2 EI2 / (4 L^2) = 0.08391 N.
TEST_F(Simulate, AnInstabilityIsToldOrRefused) {
  write("s.toml", "schema = 1\n[scenario]\ncatheter = \"" + kScenarios +
                      "catheters/ablation_straight.toml\"\nduration_s = 3\n[load]\nkind = \"force\"\n"
                      "force_base_N = [0.0, 0.0, { points = [[0, 0], [3, -0.15]] }]\n");
  const nlohmann::json played = json("s.toml", {"--rate", "20"});
  ASSERT_EQ(played.at("instabilities"), 1);
  EXPECT_THAT(played.at("events").dump(), HasSubstr("0.08391 N: the branch of equilibria followed from rest loses"));
  EXPECT_THAT(test::read_whole(path("run.events.csv")), HasSubstr("that branch is kept"));
  EXPECT_THAT(refusal({"simulate", "s.toml", "--out", "r", "--rate", "20", "--stable-only"}),
              HasSubstr("s.toml: load: at 1.678 s, 0.08391 N"));
}

}  // namespace
}  // namespace palpate
