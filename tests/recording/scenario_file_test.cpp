// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/scenario_file.hpp>
#include <palpate/recording/scenario_truth.hpp>
#include <sstream>
#include <tests/recording/temporary_folder.hpp>

namespace palpate {
namespace {

using ::testing::HasSubstr;

constexpr const char* kCatheter = R"(schema = 1
[catheter]
length_mm = 70.0
bending_stiffness_Nm2 = [0.26e-3, 0.17e-3]
torsional_stiffness_Nm2 = 0.16e-3
stiffness_sigma_percent = 5.0
precurvature_per_m = [20.0, 0.0, 0.0]
precurvature_sigma_per_m = [1.0, 0.5, 0.1]
[tendon]
model = "couple"
[base]
quaternion_wxyz = [1.0, 0.0, 0.0, 0.0]
position_mm = [1.0, 2.0, 3.0]
position_sigma_mm = 0.4
rotation_sigma_deg = 0.2
[[sensor]]
name = "tip"
arc_length_mm = 70.0
mount_sigma_mm = 0.1
noise_axes_mm = [0.1, 0.2, 0.3]
bias_mm = 0.5
[[sensor]]
name = "point"
kind = "position"
arc_length_mm = 40.0
)";

/// A catheter file's text, read back.
CatheterFile parse(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return parse_catheter({.name = "text", .lines = lines});
}

constexpr const char* kHead = "schema = 1\n[scenario]\ncatheter = \"c.toml\"\nduration_s = 2.0\nseed = 5\n";

class ScenarioFileTest : public test::TemporaryFolder {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    write("c.toml", kCatheter);
  }
  ScenarioFile read(const std::string& more, const ScenarioChanges& changes = {}) const {
    write("s.toml", kHead + more);
    return read_scenario_file(path("s.toml"), changes);
  }
  /// The message, without the folder; lines of `more` count from 6.
  std::string refusal(const std::string& more) const {
    try {
      read(more);
    } catch (const InputError& error) {
      const std::string text = error.what(), folder = path("").string();
      return text.starts_with(folder) ? text.substr(text.find("s.toml")) : text;
    }
    return "accepted";
  }
};

TEST_F(ScenarioFileTest, SignalsAreReadWithTheirUnits) {
  const Scenario s = read(
                         "[load]\nkind = \"force\"\n"
                         "force_base_N = [0.1, { constant = 0.2, sines = [{ amplitude = 0.3, frequency_hz = 2, "
                         "phase_deg = 90 }] }, { points = [[0, 1], [2, 3]], course = \"hold\" }]\n"
                         "[handle]\ntwist_deg = 180\ntranslation_mm = { points = [[0, 0], [1, 10]], course = "
                         "\"smooth\" }\n")
                         .scenario;
  const auto& load = std::get<ForceLoad>(s.load);
  EXPECT_TRUE(load.in_base);
  EXPECT_DOUBLE_EQ(load.force_N[0].at(1.0), 0.1);
  EXPECT_NEAR(load.force_N[1].at(0.125), 0.2 + 0.3 * std::cos(2.0 * std::numbers::pi * 2.0 * 0.125), 1e-12);
  EXPECT_DOUBLE_EQ(load.force_N[2].at(1.9), 1.0);
  EXPECT_DOUBLE_EQ(load.force_N[2].at(9.0), 3.0);
  EXPECT_DOUBLE_EQ(s.handle.twist_rad.at(0.0), std::numbers::pi);
  EXPECT_DOUBLE_EQ(s.handle.translation_m.at(1.0), 0.01);
  EXPECT_EQ(s.handle.translation_m.course, Signal::Course::kSmooth);
  EXPECT_FALSE(s.handle.tendon);
  EXPECT_EQ(s.name, "s");
  EXPECT_EQ(s.seed, 5U);
}

TEST_F(ScenarioFileTest, TheTrackerIsReadAndTheOperatorKnowsItsSensors) {
  const ScenarioFile file = read(
      "[tracker]\nrate_hz = 20\nnoise_mm = 0.05\nnoise_deg = 0.1\ndof = 5\nbias_mm = 0.4\n"
      "bias_deg = 0.3\nbias_length_mm = 30\nposition_step_mm = 0.01\nlatency_s = 0.02\n"
      "missing_percent = 4\noutlier_percent = 1\noutlier_mm = 30\n[flow]\nrms_N = 0.01\n");
  const TrackerErrors& e = file.scenario.tracker;
  EXPECT_DOUBLE_EQ(e.rate_hz, 20.0);
  EXPECT_DOUBLE_EQ(e.bias_m, 0.4e-3);
  EXPECT_DOUBLE_EQ(e.bias_rad, 0.3 * kRadiansPerDegree);
  EXPECT_DOUBLE_EQ(e.bias_length_m, 0.03);
  EXPECT_DOUBLE_EQ(e.position_step_m, 1e-5);
  EXPECT_DOUBLE_EQ(e.missing_share, 0.04);
  EXPECT_DOUBLE_EQ(e.outlier_m, 0.03);
  EXPECT_DOUBLE_EQ(file.scenario.flow.rms_N, 0.01);
  const Catheter again = parse(file.believed_text).catheter;
  for (const Catheter* c :
       std::initializer_list<const Catheter*>{&file.scenario.catheter, &file.believed.catheter, &again}) {
    EXPECT_EQ(c->sensors[0].kind, SensorKind::kPose5);
    EXPECT_EQ(c->sensors[1].kind, SensorKind::kPosition) << "it has no orientation to lose";
    EXPECT_TRUE(c->sensors[0].noise_m.isApprox(Vector3d::Constant(0.05e-3)));
    EXPECT_NEAR(c->sensors[0].noise_rad, 0.1 * kRadiansPerDegree, 1e-12);
  }
}

/// Who steers in flowing blood knows it, unless the catheter file says otherwise.
TEST_F(ScenarioFileTest, TheFlowIsKnown) {
  const std::string flow = "[flow]\nrms_N = 0.01\nmemory_s = 0.3\n";
  const ScenarioFile file = read(flow);
  for (const ObserverOptions& options : {file.believed.observer, parse(file.believed_text).observer}) {
    EXPECT_DOUBLE_EQ(options.disturbance_rms_N, 0.01);
    EXPECT_DOUBLE_EQ(options.disturbance_memory_s, 0.3);
  }
  EXPECT_EQ(read("").believed.observer.disturbance_rms_N, 0.0);
  write("c.toml", kCatheter + std::string("[estimator]\ndisturbance_rms_N = 0.02\n"));
  EXPECT_DOUBLE_EQ(read(flow).believed.observer.disturbance_rms_N, 0.02);
}

/// The truth differs from the file; the file does not change.
TEST_F(ScenarioFileTest, TheTruthIsNotWhatTheOperatorBelieves) {
  const ScenarioFile file = read(
      "[truth]\nprecurvature_per_m = [23.0, 1.0, 0.0]\nstiffness_factor = [1.1, 0.9, 1.0]\n"
      "base_position_mm = [0.0, 0.0, 2.0]\nbase_rotation_deg = [0.0, 90.0, 0.0]\n");
  const Catheter &truth = file.scenario.catheter, &believed = file.believed.catheter;
  EXPECT_TRUE(truth.precurvature_per_m().isApprox(Vector3d(23.0, 1.0, 0.0)));
  EXPECT_TRUE(believed.precurvature_per_m().isApprox(Vector3d(20.0, 0.0, 0.0)));
  EXPECT_TRUE(truth.rod.sections[0].stiffness_Nm2.isApprox(Stiffness(0.286e-3, 0.153e-3, 0.16e-3)));
  EXPECT_TRUE(truth.base.T_tracker_base.p.isApprox(Vector3d(1e-3, 2e-3, 5e-3)));
  EXPECT_LT((truth.base.T_tracker_base.R * Vector3d::UnitZ() - Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_TRUE(believed.base.T_tracker_base.R.isIdentity());
}

/// 2000 draws: a standard deviation scatters by 1.6 %, a correlation of 0.9 by 0.004.
TEST_F(ScenarioFileTest, TheTruthIsDrawnAsTheFileIsUnsure) {
  const Catheter believed = read("").believed.catheter;
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();
  Vector3d bend = Vector3d::Zero(), place = Vector3d::Zero(), turn = Vector3d::Zero(), mount = Vector3d::Zero();
  constexpr int kDraws = 2000;
  for (std::uint64_t seed = 0; seed < kDraws; ++seed) {
    const Catheter c = draw_catheter(believed, seed);
    const Vector3d s =
        c.rod.sections[0].stiffness_Nm2.cwiseQuotient(believed.rod.sections[0].stiffness_Nm2).array().log();
    stiffness += s * s.transpose() / kDraws;
    bend += (c.precurvature_per_m() - believed.precurvature_per_m()).cwiseAbs2() / kDraws;
    place += (c.base.T_tracker_base.p - believed.base.T_tracker_base.p).cwiseAbs2() / kDraws;
    turn += log_so3(c.base.T_tracker_base.R).cwiseAbs2() / kDraws;
    mount += c.sensors[0].T_local_sensor.p.cwiseAbs2() / kDraws;
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::sqrt(stiffness(i, i)), 0.05, 0.004);
    EXPECT_NEAR(std::sqrt(bend(i)), Vector3d(1.0, 0.5, 0.1)(i), 0.08 * Vector3d(1.0, 0.5, 0.1)(i));
    EXPECT_NEAR(std::sqrt(place(i)), 0.4e-3, 0.03e-3);
    EXPECT_NEAR(std::sqrt(turn(i)) / kRadiansPerDegree, 0.2, 0.016);
    EXPECT_NEAR(std::sqrt(mount(i)), 0.1e-3, 0.008e-3);
  }
  EXPECT_NEAR(stiffness(0, 1) / std::sqrt(stiffness(0, 0) * stiffness(1, 1)), 0.9, 0.02);
  const ScenarioFile drawn = read("[truth]\ndraw = true\n");
  EXPECT_DOUBLE_EQ(drawn.scenario.tracker.bias_m, 0.5e-3) << "the tracker's accuracy as the file has it";
  EXPECT_EQ(drawn.scenario.catheter.precurvature_per_m(),
            read("[truth]\ndraw = true\n").scenario.catheter.precurvature_per_m());
  EXPECT_NE(drawn.scenario.catheter.precurvature_per_m(),
            read("[truth]\ndraw = true\n", {.seed = 6}).scenario.catheter.precurvature_per_m());
}

/// A wall placed by the tip stands in front of it: here an arc of 20 1/m over 70 mm, in closed form.
TEST_F(ScenarioFileTest, AWallIsPlacedByTheUnloadedTip) {
  const auto wall =
      std::get<WallLoad>(read("[load]\nkind = \"wall\"\ngap_mm = 3\nstiffness_N_per_m = 100\n").scenario.load);
  const double angle = 1.4, k = 20.0;
  const Vector3d tip(0.0, -(1.0 - std::cos(angle)) / k, std::sin(angle) / k),
      along(0.0, -std::sin(angle), std::cos(angle));
  EXPECT_LT((wall.normal_base + along).norm(), 1e-6);
  EXPECT_LT((wall.point_base_m - (tip + 3e-3 * along)).norm(), 1e-8);
}

TEST_F(ScenarioFileTest, WhatTheUserAsksForStandsInPlaceOfTheFiles) {
  const Scenario s = read("[tracker]\nmissing_percent = 5\nbias_mm = 1\n",
                          {.seed = 9, .duration_s = 0.5, .rate_hz = 100.0, .noise_free = true})
                         .scenario;
  EXPECT_EQ(s.seed, 9U);
  EXPECT_DOUBLE_EQ(s.duration_s, 0.5);
  EXPECT_DOUBLE_EQ(s.tracker.rate_hz, 100.0);
  EXPECT_DOUBLE_EQ(s.tracker.missing_share + s.tracker.bias_m, 0.0);
  EXPECT_LT(s.catheter.sensors[0].noise_m.maxCoeff(), 1e-11);
}

struct Bad {
  const char* text;
  const char* message;
};

TEST_F(ScenarioFileTest, EachMistakeIsNamedWithItsLine) {
  const Bad cases[] = {
      {"[lode]\n", "s.toml:6: lode = {...}: expected a known key; did you mean load?"},
      {"[load]\nkind = \"wal\"\n", "s.toml:7: load.kind = \"wal\": expected one of 'force', 'pulley', 'wall'"},
      {"[load]\nmass_g = 1\n", "s.toml:6: load.kind = (absent): expected one of"},
      {"[load]\nkind = \"pulley\"\nmass_g = -13.03\npulley_base_mm = [0, 0, 0]\n",
       "s.toml:8: load.mass_g = -13.03: expected a mass in g, more than 0"},
      {"[load]\nkind = \"pulley\"\nstiffness_N_per_m = 3\n",
       "s.toml:8: load.stiffness_N_per_m = 3: expected a known key"},
      {"[load]\nkind = \"force\"\nforce_tip_N = [0, { points = [[0, 0], [2, 0.1], [1, 0.2]] }, 0]\n",
       "s.toml:8: load.force_tip_N[1].points = [[0, 0], [2, 0.1], [1, 0.2]]: expected times that rise, here 1 s after "
       "2 s"},
      {"[load]\nkind = \"force\"\nforce_tip_N = [0, { amplitude = 1 }, 0]\n",
       "load.force_tip_N[1].amplitude = 1: expected a known key"},
      {"[load]\nkind = \"force\"\nforce_tip_N = [0, 1000, 0]\n", "expected a force in N, at most 100"},
      {"[load]\nkind = \"force\"\nforce_tip_N = [0, {}, 0]\n", "expected constant, sines or points"},
      {"[load]\nkind = \"wall\"\nstiffness_N_per_m = 1\n", "s.toml:6: load.point_base_mm = (absent)"},
      {"[load]\nkind = \"wall\"\nstiffness_N_per_m = 1\ngap_mm = 1\nfriction = 0.2\n",
       "s.toml:6: load.tangential_stiffness_N_per_m"},
      {"[tracker]\nmissing_percent = 100\n", "s.toml:7: tracker.missing_percent = 100: expected percent, 0..99"},
      {"[tracker]\nnoise_free = true\nbias_mm = 1\n", "s.toml:8: tracker.bias_mm = 1: expected no such key"},
      {"[tracker]\ndof = 4\n", "s.toml:7: tracker.dof = 4: expected 5 or 6"},
      {"[truth]\ndraw = true\nstiffness_factor = 1.1\n", "s.toml:8: truth.stiffness_factor = 1.1: expected either"},
      {"[handle]\nknob_rad = 1.0\n", "s.toml:7: handle.knob_rad = 1: expected a catheter file with [tendon_map]"},
      {"[stiffness]\nfactor = { constant = 1, sines = [{ amplitude = 1.5, frequency_hz = 1 }] }\n",
       "s.toml:7: stiffness.factor = {...}: expected a factor of the stiffness"},
      {"[flow]\nrms_N = -0.1\n", "s.toml:7: flow.rms_N = -0.1: expected a force in N, 0..10"},
  };
  for (const Bad& bad : cases) EXPECT_THAT(refusal(bad.text), HasSubstr(bad.message)) << bad.text;
}

TEST_F(ScenarioFileTest, ACatheterThatIsNotThere) {
  write("s.toml", "schema = 1\n[scenario]\ncatheter = \"d.toml\"\n");
  try {
    read_scenario_file(path("s.toml"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("s.toml:3: scenario.catheter = \"d.toml\": expected a catheter file; there is no file"));
  }
}

}  // namespace
}  // namespace palpate
