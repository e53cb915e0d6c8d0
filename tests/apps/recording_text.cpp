// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/csv_writers.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <sstream>
#include <stdexcept>
#include <tests/apps/recording_text.hpp>
#include <tests/apps/run_program.hpp>

namespace palpate::test {
namespace {

constexpr const char* kHeader = "time_s,frame,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm,error_mm";

constexpr const char* kCatheter = R"(schema = 1
[catheter]
name = "virtual ablation catheter"
length_mm = 70.0
bending_stiffness_Nm2 = [0.2612e-3, 0.16664e-3]
torsional_stiffness_Nm2 = 0.1645e-3
precurvature_per_m = [24.57, 0.0, 0.0]
[base]
quaternion_wxyz = [0.7071067811865476, 0.0, 0.7071067811865476, 0.0]
position_mm = [20.0, -40.0, -180.0]
#SIGMAS
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
)";

/// What a virtual tracker sees of this catheter, its clamp displaced by `shift` in the file's base frame.
CleanRecording simulate(const std::string& catheter_file, const ForceSchedule& force, double duration_s,
                        const Pose& shift) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("palpate-made-recording-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "c.toml") << catheter_file;
  Catheter catheter = read_catheter_file(folder / "c.toml").catheter;
  catheter.base.T_tracker_base = catheter.base.T_tracker_base * shift;
  const VirtualRecording made = simulate_tracker(catheter, force, {.duration_s = duration_s, .seed = 11});
  write_tracker_csv(folder / "r.csv", catheter, made.frames);
  CleanRecording recording{catheter_file, RecordingText::parse(read_whole(folder / "r.csv")), made.force_tip_N};
  std::filesystem::remove_all(folder);
  return recording;
}

}  // namespace

RecordingText RecordingText::parse(const std::string& csv) {
  RecordingText recording;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  if (line != kHeader) throw std::runtime_error("unexpected header: " + line);
  while (std::getline(lines, line)) {
    Row& row = recording.rows.emplace_back();
    std::istringstream fields(line);
    for (std::string& field : row) std::getline(fields, field, ',');
  }
  return recording;
}

std::string RecordingText::text() const {
  std::string csv = std::string(kHeader) + "\n";
  for (const Row& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) csv += row[i] + (i + 1 < row.size() ? "," : "\n");
  return csv;
}

RecordingText::Row& RecordingText::at(int frame, const std::string& sensor) {
  for (Row& row : rows)
    if (row[kFrame] == std::to_string(frame) && row[kSensor] == sensor) return row;
  throw std::runtime_error("no such row");
}

std::vector<RecordingText::Row*> RecordingText::frame(int number) { return {&at(number, "tip"), &at(number, "shaft")}; }

void RecordingText::set_missing(Row& row) {
  row[kStatus] = "MISSING";
  for (std::size_t i = kQ0; i <= kError; ++i) row[i].clear();
}

void RecordingText::set_pose(Row& row, const std::array<const char*, 7>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) row[kQ0 + i] = values[i];
}

CleanRecording make_recording(double duration_s) { return simulate(kCatheter, beating_wall_force, duration_s, Pose{}); }

const CleanRecording& beating_recording() {
  static const CleanRecording recording = make_recording(4.0);
  return recording;
}

const CleanRecording& shifted_recording() {
  static const CleanRecording recording = [] {
    std::string catheter = kCatheter;
    catheter.replace(catheter.find("#SIGMAS"), 7, "position_sigma_mm = 2.0\nrotation_sigma_deg = 1.0");
    Pose shift;
    shift.p = {2e-3, 0.0, 0.0};
    shift.R = Eigen::AngleAxisd(kRadiansPerDegree, Vector3d::UnitX()).toRotationMatrix();
    const auto late = [](double time_s) -> Vector3d {
      return time_s < 2.0 ? Vector3d::Zero() : beating_wall_force(time_s);
    };
    return simulate(catheter, late, 4.0, shift);
  }();
  return recording;
}

}  // namespace palpate::test
