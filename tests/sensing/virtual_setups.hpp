// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <palpate/rod/base_loads.hpp>
#include <palpate/sensing/catheter.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <stdexcept>
#include <string>
#include <tests/random_draws.hpp>
#include <vector>

/// Catheters in front of a tracker, and the readings they give: without noise, or with the noise that they state. Apart
/// from palpate/simulation, which is itself under test.
namespace palpate::test {

inline Sensor sensor_at(const std::string& name, double arc_length_m, SensorKind kind = SensorKind::kPose) {
  Sensor sensor;
  sensor.name = name;
  sensor.arc_length_m = arc_length_m;
  sensor.kind = kind;
  return sensor;
}

inline Pose some_pose() { return {Draws::turn({0.4, -1.1, 0.7}), {0.05, -0.12, -0.3}}; }
inline Pose some_mounting() { return {Draws::turn({0.3, 0.5, -0.9}), {0.6e-3, -0.4e-3, 0.2e-3}}; }

/// The paper's shaft (Table 2) bent by k1,0 = 30 1/m, clamped somewhere in the tracker's frame, without sensors.
inline Catheter bare_catheter() {
  Catheter catheter;
  catheter.name = "test";
  catheter.rod = uniform_rod(0.07, {2.612e-4, 1.6664e-4, 1.645e-4}, {30.0, 0.0, 0.0});
  catheter.base.T_tracker_base = some_pose();
  return catheter;
}

/// Sensors of one kind at the tip and 4.7 mm behind it.
inline Catheter two_sensors(SensorKind kind = SensorKind::kPose) {
  Catheter catheter = bare_catheter();
  catheter.sensors = {sensor_at("tip", 0.07, kind), sensor_at("shaft", 0.0653, kind)};
  return catheter;
}

inline Catheter mixed_sensors() {
  Catheter catheter = bare_catheter();
  catheter.sensors = {sensor_at("tip", 0.07), sensor_at("needle", 0.0653, SensorKind::kPose5),
                      sensor_at("marker", 0.035, SensorKind::kPosition)};
  catheter.sensors[1].T_local_sensor = some_mounting();
  catheter.sensors[2].T_local_sensor.p = {0.0, 1e-3, 0.0};
  return catheter;
}

inline Catheter eight_sensors() {
  Catheter catheter = bare_catheter();
  for (int i = 0; i < kMaxSensors; ++i) catheter.sensors.push_back(sensor_at(fmt::format("s{}", i), 0.07 - 0.008 * i));
  return catheter;
}

inline Catheter mounted(Catheter catheter) {
  for (Sensor& sensor : catheter.sensors) sensor.T_local_sensor = some_mounting();
  return catheter;
}

/// Base watched by a sensor of its own, mounted askew, with noise that differs from axis to axis.
inline Catheter with_tracked_base(Catheter catheter) {
  catheter.base.tracked = true;
  catheter.base.sensor = sensor_at("base", 0.0);
  catheter.base.sensor.T_local_sensor = {Draws::turn({-0.8, 0.2, 0.6}), {-5e-3, 8e-3, -12e-3}};
  catheter.base.sensor.noise_m = {0.1e-3, 0.2e-3, 0.5e-3};
  catheter.base.sensor.noise_rad = 0.2 * kRadiansPerDegree;
  return catheter;
}

/// The last sensor is watched by another tracker, whose frame has nothing to do with that of the others.
inline Catheter with_second_tracker(Catheter catheter) {
  catheter.sensors.back().T_tracker_base = Pose{Draws::turn({1.2, 0.3, -2.0}), {-0.7, 0.4, 1.1}};
  return catheter;
}

/// Heavy enough to bend the shaft by several degrees.
inline Catheter with_own_weight(Catheter catheter) {
  catheter.rod.distributed_load_base_N_per_m = {0.05, -0.3, 0.1};
  return catheter;
}

inline SensorReading reading_of(const Pose& T_tracker_sensor, SensorKind kind = SensorKind::kPose) {
  SensorReading reading;
  reading.status = SensorReading::Status::kOk;
  reading.position_m = T_tracker_sensor.p;
  if (kind == SensorKind::kPosition) return reading;
  reading.has_orientation = true;
  const Eigen::Quaterniond q(T_tracker_sensor.R);
  reading.quaternion_wxyz << q.w(), q.x(), q.y(), q.z();
  return reading;
}

struct TrueFrame {
  TrackerFrame frame;
  Pose T_base_tip;
};

inline TrueFrame true_frame(const Catheter& catheter, const TipLoad& load) {
  std::vector<double> arc_lengths_m;
  for (const Sensor& sensor : catheter.sensors) arc_lengths_m.push_back(sensor.arc_length_m);
  const RodSolver solver(catheter.rod, arc_lengths_m, Accuracy::kReference);
  RodSolution<3> shape = solver.make_solution<3>();
  auto workspace = make_weight_workspace<3>(solver);
  if (!solve_under_weight(solver, load, LoadDirections<3>{}, workspace, shape).converged)
    throw std::runtime_error("no equilibrium");
  TrueFrame out{.frame = {}, .T_base_tip = shape.T_base_tip};
  const Pose& T_tracker_base = catheter.base.T_tracker_base;
  for (std::size_t i = 0; i < catheter.sensors.size(); ++i) {
    const Sensor& sensor = catheter.sensors[i];
    const Pose T =
        sensor.T_tracker_base.value_or(T_tracker_base) * shape.points[i].T_base_local * sensor.T_local_sensor;
    out.frame.readings.push_back(reading_of(T, sensor.kind));
  }
  if (catheter.base.tracked)
    out.frame.readings.push_back(reading_of(T_tracker_base * catheter.base.sensor.T_local_sensor));
  return out;
}

inline TrackerFrame exact_frame(const Catheter& catheter, const Vector3d& force_tip_N, double time_s = 0.0) {
  TrackerFrame frame = true_frame(catheter, {.force_tip_N = force_tip_N}).frame;
  frame.time_s = time_s;
  return frame;
}

inline Matrix3d rotation_of(const SensorReading& reading) {
  const Eigen::Vector4d& q = reading.quaternion_wxyz;
  return Eigen::Quaterniond(q(0), q(1), q(2), q(3)).toRotationMatrix();
}

/// White noise as Sensor states it: position along the base axes, orientation R exp(n) in sensor axes.
inline TrackerFrame with_noise(const Catheter& catheter, TrackerFrame frame, Draws& draws) {
  for (std::size_t i = 0; i < frame.readings.size(); ++i) {
    SensorReading& reading = frame.readings[i];
    const Sensor& sensor = i < catheter.sensors.size() ? catheter.sensors[i] : catheter.base.sensor;
    const Matrix3d R_tracker_base = sensor.T_tracker_base.value_or(catheter.base.T_tracker_base).R;
    const Pose noisy{reading.has_orientation ? Matrix3d(rotation_of(reading) * draws.small_turn(sensor.noise_rad))
                                             : Matrix3d::Identity(),
                     reading.position_m + R_tracker_base * sensor.noise_m.cwiseProduct(draws.normal3())};
    reading = reading_of(noisy, reading.has_orientation ? SensorKind::kPose : SensorKind::kPosition);
  }
  return frame;
}

/// The same readings seen by a tracker that stands elsewhere: every pose becomes `move` times it.
inline TrackerFrame moved(const Pose& move, TrackerFrame frame) {
  for (SensorReading& reading : frame.readings) {
    const Pose T{reading.has_orientation ? rotation_of(reading) : Matrix3d::Identity(), reading.position_m};
    reading = reading_of(move * T, reading.has_orientation ? SensorKind::kPose : SensorKind::kPosition);
  }
  return frame;
}

inline Catheter moved(const Pose& move, Catheter catheter) {
  catheter.base.T_tracker_base = move * catheter.base.T_tracker_base;
  for (Sensor& sensor : catheter.sensors)
    if (sensor.T_tracker_base) sensor.T_tracker_base = move * *sensor.T_tracker_base;
  return catheter;
}

}  // namespace palpate::test
