// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <palpate/math/errors.hpp>
#include <palpate/recording/marker_csv.hpp>
#include <palpate/rod/base_loads.hpp>
#include <span>

namespace palpate {
namespace {

using Points = Eigen::Matrix<double, 3, Eigen::Dynamic>;

/// Second to first extent of a triad below which its roll about the line is not measured.
constexpr double kCollinear = 0.01;

struct MarkerSensor {
  const Sensor* sensor = nullptr;
  std::vector<std::size_t> markers;
  Points reference;                                     ///< mean over the reference interval; pose sensors only
  Matrix3d R_tracker_reference = Matrix3d::Identity();  ///< orientation of the sensor then
};

std::vector<std::size_t> find_markers(const MarkerRecording& recording, const Sensor& sensor) {
  const std::size_t least = sensor.kind == SensorKind::kPosition ? 1 : 3;
  if (sensor.markers.size() < least) {
    throw InputError(
        fmt::format("{}: sensor {}: markers = [{}]: expected at least {} in the catheter file, for this is "
                    "a marker recording",
                    recording.source, sensor.name, fmt::join(sensor.markers, ", "), least));
  }
  std::vector<std::size_t> indices;
  for (const std::string& name : sensor.markers) {
    const auto found = std::find(recording.names.begin(), recording.names.end(), name);
    if (found == recording.names.end()) {
      throw InputError(fmt::format("{}: sensor {}: marker {}: expected one of {}", recording.source, sensor.name, name,
                                   fmt::join(recording.names, ", ")));
    }
    indices.push_back(static_cast<std::size_t>(found - recording.names.begin()));
  }
  return indices;
}

Points gather(const std::vector<Vector3d>& positions, const std::vector<std::size_t>& markers) {
  Points points(3, static_cast<Eigen::Index>(markers.size()));
  for (std::size_t i = 0; i < markers.size(); ++i) points.col(static_cast<Eigen::Index>(i)) = positions[markers[i]];
  return points;
}

Points mean_over_reference(const MarkerRecording& recording, const MarkerSensor& sensor,
                           const RecordingOptions& options) {
  Points sum = Points::Zero(3, static_cast<Eigen::Index>(sensor.markers.size()));
  int count = 0;
  for (std::size_t i = 0; i < recording.times_s.size(); ++i) {
    const double time_s = recording.times_s[i];
    if (!(time_s >= options.reference_from_s && time_s <= options.reference_to_s)) continue;
    const Points points = gather(recording.positions_m[i], sensor.markers);
    if (!points.allFinite()) continue;
    sum += points;
    ++count;
  }
  if (count == 0) {
    throw InputError(
        fmt::format("{}: sensor {}: reference interval {}..{} s: expected frames in which all its markers "
                    "are seen ([reference] from_s, to_s in the catheter file, or --reference)",
                    recording.source, sensor.sensor->name, options.reference_from_s, options.reference_to_s));
  }
  return sum / count;
}

void refuse_collinear(const MarkerRecording& recording, const MarkerSensor& sensor) {
  const Points centred = sensor.reference.colwise() - sensor.reference.rowwise().mean();
  const auto extents = Eigen::JacobiSVD<Eigen::MatrixXd>(centred).singularValues();
  if (extents(1) > kCollinear * extents(0)) return;
  throw InputError(fmt::format("{}: sensor {}: markers {}: expected markers that are not on a line, for a pose",
                               recording.source, sensor.sensor->name, fmt::join(sensor.sensor->markers, ", ")));
}

/// Local frame at arc length s of the shaft without tip force, in the base frame.
Matrix3d unloaded_local_frame(const Catheter& catheter, double s_m) {
  const RodSolver solver(catheter.rod, std::span(&s_m, 1));
  RodSolution<3> shape = solver.make_solution<3>();
  WeightWorkspace<3> workspace = make_weight_workspace<3>(solver);
  solve_under_weight(solver, TipLoad{}, LoadDirections<3>{}, workspace, shape);
  return shape.points[0].T_base_local.R;
}

MarkerSensor make_sensor(const MarkerRecording& recording, const Sensor& sensor, const RecordingOptions& options,
                         bool on_shaft) {
  MarkerSensor made{&sensor, find_markers(recording, sensor), {}};
  if (sensor.kind == SensorKind::kPosition) return made;
  made.reference = mean_over_reference(recording, made, options);
  refuse_collinear(recording, made);
  const Catheter& catheter = *options.catheter;
  const bool bent = on_shaft && !options.reference_straight;
  made.R_tracker_reference = catheter.T_tracker_base(sensor).R *
                             (bent ? unloaded_local_frame(catheter, sensor.arc_length_m) : Matrix3d::Identity()) *
                             sensor.T_local_sensor.R;
  return made;
}

SensorReading read_sensor(const MarkerSensor& sensor, const std::vector<Vector3d>& positions) {
  SensorReading reading;
  reading.has_orientation = sensor.sensor->kind != SensorKind::kPosition;
  const Points points = gather(positions, sensor.markers);
  if (!points.allFinite()) return reading;
  reading.status = SensorReading::Status::kOk;
  reading.position_m = points.rowwise().mean();
  if (!reading.has_orientation) return reading;
  const Matrix3d R_moved = Eigen::umeyama(sensor.reference, points, false).topLeftCorner<3, 3>();
  const Eigen::Quaterniond q(Matrix3d(R_moved * sensor.R_tracker_reference));
  reading.quaternion_wxyz << q.w(), q.x(), q.y(), q.z();
  return reading;
}

}  // namespace

TrackerRecording assemble_sensors(const MarkerRecording& markers, const RecordingOptions& options) {
  if (options.catheter == nullptr) {
    throw InputError(markers.source + ": a marker recording: expected a catheter whose sensors list markers");
  }
  const Catheter& catheter = *options.catheter;
  std::vector<MarkerSensor> sensors;
  const auto add = [&](const Sensor& sensor, bool on_shaft) {
    if (options.one_of_several && sensor.markers.empty()) return;
    sensors.push_back(make_sensor(markers, sensor, options, on_shaft));
  };
  for (const Sensor& sensor : catheter.sensors) add(sensor, true);
  if (catheter.base.tracked) add(catheter.base.sensor, false);
  if (sensors.empty())
    throw InputError(markers.source + ": a marker recording: expected a sensor of the catheter file to list markers");

  TrackerRecording recording;
  recording.source = markers.source;
  for (const MarkerSensor& sensor : sensors) recording.sensor_names.push_back(sensor.sensor->name);
  recording.sensor_lines.assign(sensors.size(), 1);
  for (std::size_t i = 0; i < markers.times_s.size(); ++i) {
    TrackerFrame& frame = recording.frames.emplace_back();
    frame.time_s = markers.times_s[i];
    frame.number = static_cast<std::int64_t>(i);
    for (const MarkerSensor& sensor : sensors) {
      frame.readings.push_back(read_sensor(sensor, markers.positions_m[i]));
    }
  }
  return recording;
}

}  // namespace palpate
