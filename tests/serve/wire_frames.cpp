// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <palpate/link/header.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/service/pose_message.hpp>
#include <stdexcept>
#include <tests/serve/wire_frames.hpp>

namespace palpate::serve_test {
namespace {

constexpr std::string_view kCatheter = R"(schema = 1
[catheter]
name = "virtual ablation catheter"
length_mm = 70.0
bending_stiffness_Nm2 = [0.2612e-3, 0.16664e-3]
torsional_stiffness_Nm2 = 0.1645e-3
precurvature_per_m = [BEND, 0.0, 0.0]
[base]
quaternion_wxyz = [0.7071067811865476, 0.0, 0.7071067811865476, 0.0]
position_mm = [20.0, -40.0, -180.0]
[[sensor]]
name = "Tip"
kind = "pose"
arc_length_mm = 70.0
noise_mm = 0.28
noise_deg = 0.17
[[sensor]]
name = "Shaft"
kind = "pose"
arc_length_mm = 65.3
noise_mm = 0.28
noise_deg = 0.17
)";

link::Matrix matrix_of(const SensorReading& reading) {
  const Eigen::Vector4d& q = reading.quaternion_wxyz;
  const Matrix3d R = Eigen::Quaterniond(q(0), q(1), q(2), q(3)).toRotationMatrix();
  link::Matrix out;
  for (int i = 0; i < 9; ++i) out.columns[static_cast<std::size_t>(i)] = static_cast<float>(R(i % 3, i / 3));
  for (int i = 0; i < 3; ++i)
    out.columns[static_cast<std::size_t>(9 + i)] = static_cast<float>(kMillimetresPerMetre * reading.position_m(i));
  return out;
}

}  // namespace

std::string catheter_text(bool straight) {
  std::string text(kCatheter);
  return text.replace(text.find("BEND"), 4, straight ? "0.0" : "24.57");
}

CatheterFile catheter_file(bool straight) {
  const std::string toml = catheter_text(straight);
  TextFile text{.name = "c.toml", .lines = {}};
  for (const std::string_view line : split(toml, '\n')) text.lines.emplace_back(line);
  return parse_catheter(text);
}

link::Matrix& WireFrame::of(const std::string& device) {
  for (auto& [name, matrix] : poses)
    if (name == device) return matrix;
  throw std::runtime_error("no " + device + " in this frame");
}

VirtualWire virtual_wire(const Catheter& catheter, double rate_hz, double duration_s, const ForceSchedule& force) {
  const VirtualRecording run =
      simulate_tracker(catheter, force, {.rate_hz = rate_hz, .duration_s = duration_s, .seed = 11});
  VirtualWire out;
  out.force_tip_N = run.force_tip_N;
  for (const TrackerFrame& frame : run.frames)
    out.frames.push_back(
        {wire_time(frame.time_s), {{kTip, matrix_of(frame.readings[0])}, {kShaft, matrix_of(frame.readings[1])}}});
  return out;
}

double utc_s() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

double wire_time(double time_s) { return link::seconds_of(link::stamp_of(time_s).value()); }

WireFrames moved_to(WireFrames frames, double start_s) {
  const double first_s = frames.front().time_s;
  for (WireFrame& frame : frames) frame.time_s = wire_time(start_s + (frame.time_s - first_s));
  return frames;
}

std::vector<TrackerFrame> tracker_frames(const WireFrames& frames) {
  std::vector<TrackerFrame> out;
  for (const WireFrame& sent : frames) {
    TrackerFrame& frame = out.emplace_back();
    frame.time_s = sent.time_s;
    frame.number = static_cast<std::int64_t>(out.size()) - 1;
    frame.readings.resize(2);
    for (const auto& [device, matrix] : sent.poses)
      frame.readings[device == kTip ? 0 : 1] = service::reading_of(matrix);
  }
  return out;
}

std::vector<Estimate> offline(const CatheterFile& file, const WireFrames& frames) {
  ForceObserver observer(file.catheter, file.observer);
  std::vector<Estimate> out;
  for (const TrackerFrame& frame : tracker_frames(frames)) out.push_back(observer.update(frame));
  return out;
}

double rmse_N(const std::vector<Vector3d>& forces, const std::vector<Vector3d>& truth, std::size_t from) {
  double sum = 0.0;
  const std::size_t count = std::min(forces.size(), truth.size());
  for (std::size_t i = from; i < count; ++i) sum += (forces[i] - truth[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(count - from));
}

}  // namespace palpate::serve_test
