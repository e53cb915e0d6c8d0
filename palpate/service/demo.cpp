// SPDX-License-Identifier: Apache-2.0
#include <palpate/recording/text_table.hpp>
#include <palpate/service/demo.hpp>
#include <palpate/service/settings.hpp>

namespace palpate::service {

namespace {

constexpr std::string_view kCatheter = R"(schema = 1

[catheter]
name = "demonstration"
length_mm = 70.0
bending_stiffness_Nm2 = [0.2612e-3, 0.16664e-3]
torsional_stiffness_Nm2 = 0.1645e-3
precurvature_per_m = [24.57, 0.0, 0.0]

[base]
quaternion_wxyz = [1.0, 0.0, 0.0, 0.0]
position_mm = [0.0, 0.0, 0.0]

[[sensor]]
name = "tip"
kind = "pose"
arc_length_mm = 70.0
noise_mm = 0.28
noise_deg = 0.17

[[sensor]]
name = "shaft"
kind = "pose"
arc_length_mm = 65.3
noise_mm = 0.28
noise_deg = 0.17

[estimator]
method = "iekf"
state = ["force"]
)";

}  // namespace

Settings demo_settings() {
  Settings out;
  out.source = "--demo";
  CatheterSettings& catheter = out.catheters.emplace_back();
  catheter.name = "demo";
  catheter.file = "demonstration";
  catheter.toml = kCatheter;
  TextFile text{.name = catheter.file, .lines = {}};
  for (const std::string_view line : split(kCatheter, '\n')) text.lines.emplace_back(line);
  catheter.settings = parse_catheter(text);
  catheter.sensor_names = {"tip", "shaft"};
  catheter.source = {.kind = SourceSettings::Kind::kDemo, .loop = true};
  return out;
}

/// Where the unloaded tip stands, a wall behind it that beats as a heart and breathes.
Scenario demo_scenario(const Catheter& catheter) {
  const RodSolver solver(catheter.rod, {});
  RodSolution<0> shape = solver.make_solution<0>();
  solver.solve({}, shape);
  const Vector3d normal = shape.T_base_tip.R * Vector3d(0.0, -0.5, -1.0).normalized();
  WallLoad wall;
  wall.point_base_m = shape.T_base_tip.p - 1e-3 * normal;
  wall.normal_base = normal;
  wall.stiffness_N_per_m = 150.0;
  wall.tangential_stiffness_N_per_m = 100.0;
  wall.friction = 0.4;
  // The tissue comes to the tip, stays for a dozen breaths and leaves it again: some 8 to 34 g with every beat.
  wall.along_normal_m = {.sines = {{.amplitude = 1e-3, .frequency_hz = 0.25}},
                         .points = {{0.0, 0.0}, {2.0, 3.5e-3}, {54.0, 3.5e-3}, {56.0, -6e-3}, {60.0, -6e-3}},
                         .course = Signal::Course::kSmooth};
  wall.heart = {.beats_per_min = 70.0, .amplitude_m = 4e-3, .interval_spread = 0.05, .size_spread = 0.08};
  Scenario out;
  out.name = "demonstration";
  out.catheter = catheter;
  out.duration_s = 60.0;
  out.load = wall;
  return out;
}

}  // namespace palpate::service
