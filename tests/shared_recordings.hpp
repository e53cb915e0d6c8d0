// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/recording/estimate_csv.hpp>
#include <palpate/recording/force_csv.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <tests/shared_data.hpp>

/// The virtual recordings with known force that another program made, and the observer's run over them.
namespace palpate::test {

inline constexpr const char* kRecordings = "recordings";

inline nlohmann::json recordings_json(const char* file) {
  return nlohmann::json::parse(std::ifstream(shared_data(kRecordings) / file));
}

inline Vector3d vector3(const nlohmann::json& j) {
  return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}

inline Pose pose_of(const nlohmann::json& j) {
  const auto& q = j.at("quaternion_wxyz");
  const Eigen::Quaterniond turn(q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(),
                                q.at(3).get<double>());
  return {turn.normalized().toRotationMatrix(), vector3(j.at("position_mm")) * kMetresPerMillimetre};
}

inline Catheter catheter_of(const nlohmann::json& j) {
  const auto number = [&](const char* key) { return j.at(key).get<double>(); };
  // Where a constant tendon couple bends the shaft, that is the same as a precurvature of M / EI1.
  const double bend_per_m = j.contains("tendon_moment_1_Nm")
                                ? number("tendon_moment_1_Nm") / number("bending_stiffness_1_Nm2")
                                : number("precurvature_1_per_m");
  Catheter catheter;
  catheter.rod = uniform_rod(
      number("length_m"),
      {number("bending_stiffness_1_Nm2"), number("bending_stiffness_2_Nm2"), number("torsional_stiffness_Nm2")},
      {bend_per_m, 0.0, 0.0});
  for (const char* name : {"tip", "shaft"}) {
    Sensor& sensor = catheter.sensors.emplace_back();
    sensor.name = name;
    sensor.arc_length_m = std::min(j.at("sensor_arc_length_m").at(name).get<double>(), catheter.rod.length_m());
    sensor.noise_m.setConstant(number("noise_sd_mm_per_axis") * kMetresPerMillimetre);
    sensor.noise_rad = number("noise_sd_deg_per_axis") * kRadiansPerDegree;
  }
  catheter.base.T_tracker_base = pose_of(j.at("base_in_tracker"));
  return catheter;
}

struct SharedRecording {
  Catheter catheter;
  std::vector<TrackerFrame> frames;
  ForceTrace truth;  ///< row i is frame i
  /// Cramer-Rao bound of a single frame, root mean square over the recording; zero where none is given.
  Vector3d rms_bound_N = Vector3d::Zero();
};

inline SharedRecording shared_recording(const std::string& name) {
  const std::filesystem::path folder = shared_data(kRecordings);
  SharedRecording out;
  out.catheter = catheter_of(recordings_json("recordings.json").at(name));
  TrackerRecording recording = read_tracker_recording(folder / (name + ".tracker.csv"));
  bind_to_catheter(recording, out.catheter);
  out.frames = std::move(recording.frames);
  out.truth = read_force_csv(folder / (name + ".force.csv"));
  const nlohmann::json bounds = recordings_json("bounds.json");
  if (bounds.contains(name)) out.rms_bound_N = vector3(bounds.at(name).at("rms_bound_tip_frame_N"));
  return out;
}

/// Online and smoothed, a row a frame.
struct SharedRun {
  std::vector<Estimate> estimates;
  std::vector<EstimateRow> online, smoothed;
};

inline SharedRun run(const SharedRecording& recording, const ObserverOptions& options) {
  ForceObserver observer(recording.catheter, options);
  RecordingSmoother smoother(observer.motion().model(), observer.motion().parameters().prior());
  SharedRun out;
  for (const TrackerFrame& frame : recording.frames) {
    const Estimate& e = out.estimates.emplace_back(observer.update(frame));
    out.online.push_back({e.time_s, e.force_tip_N, e.covariance_tip_N2, e.status});
    smoother.push(observer.motion().step(), observer.motion().belief());
  }
  const std::vector<SmoothedFrame> smooth = smoother.smooth();
  for (std::size_t i = 0; i < smooth.size(); ++i)
    out.smoothed.push_back(
        {out.online[i].time_s, smooth[i].force.mean_N, smooth[i].force.covariance_N2, out.online[i].status});
  return out;
}

}  // namespace palpate::test
