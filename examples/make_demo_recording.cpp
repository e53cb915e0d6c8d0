// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/csv_writers.hpp>
#include <palpate/recording/output_file.hpp>
#include <palpate/simulation/virtual_tracker.hpp>

namespace {

/// The paper's ablation catheter (Table 2), bent to 24.57 1/m, with two electromagnetic sensors 4.7 mm apart.
constexpr const char* kCatheterFile = R"(# The demo's catheter: made by make_demo_recording
schema = 1

[catheter]
name = "Demo: virtual ablation catheter against a beating wall"
length_mm = 70.0
bending_stiffness_Nm2 = [0.2612e-3, 0.16664e-3]
torsional_stiffness_Nm2 = 0.1645e-3
precurvature_per_m = [24.57, 0.0, 0.0]

[base]
quaternion_wxyz = [0.7071067811865476, 0.0, 0.7071067811865476, 0.0]
position_mm = [20.0, -40.0, -180.0]

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
)";

}  // namespace

/// Writes demo.catheter.toml, demo.tracker.csv and demo.force.csv into the folder given: 30 s, or as many as asked for,
/// at 40 Hz.
int main(int argc, char** argv) {
  const double duration_s = argc == 3 ? std::atof(argv[2]) : 30.0;
  if (argc < 2 || argc > 3 || !(duration_s > 0.0)) {
    std::fprintf(stderr, "usage: make_demo_recording FOLDER [SECONDS]\n");
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    palpate::OutputFile file(folder / "demo.catheter.toml");
    file.write(kCatheterFile);
    file.commit();
    const palpate::Catheter catheter = palpate::read_catheter_file(folder / "demo.catheter.toml").catheter;
    const palpate::VirtualRecording recording = palpate::simulate_tracker(
        catheter, palpate::beating_wall_force,
        {.rate_hz = 40.0, .duration_s = duration_s, .seed = 7, .missing_share = 0.02, .outlier_share = 0.005});
    palpate::write_tracker_csv(folder / "demo.tracker.csv", catheter, recording.frames);
    palpate::write_force_csv(folder / "demo.force.csv", recording.frames, recording.force_tip_N,
                             recording.force_base_N);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_demo_recording: %s\n", error.what());
    return 2;
  }
  return 0;
}
