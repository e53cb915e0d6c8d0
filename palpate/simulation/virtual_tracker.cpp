// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <palpate/math/errors.hpp>
#include <palpate/simulation/virtual_tracker.hpp>

namespace palpate {

namespace {

/// Draws in a fixed order, so that a seed fixes the recording.
class NoiseSource {
 public:
  explicit NoiseSource(std::uint64_t seed) : engine_(seed) {}
  Vector3d normal(double sigma) {
    const double x = normal_(engine_), y = normal_(engine_), z = normal_(engine_);
    return sigma * Vector3d(x, y, z);
  }
  bool happens(double share) { return uniform_(engine_) < share; }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
};

SensorReading read_sensor(const Sensor& sensor, const Pose& T_tracker_sensor, const Matrix3d& R_tracker_base,
                          const VirtualTrackerOptions& options, NoiseSource& noise) {
  SensorReading reading;
  reading.status = SensorReading::Status::kOk;
  reading.has_orientation = sensor.kind != SensorKind::kPosition;
  reading.position_m = T_tracker_sensor.p + R_tracker_base * sensor.noise_m.cwiseProduct(noise.normal(1.0));
  const Matrix3d R = T_tracker_sensor.R * exp_so3(noise.normal(sensor.noise_rad));
  if (reading.has_orientation) {
    const Eigen::Quaterniond q(R);
    reading.quaternion_wxyz << q.w(), q.x(), q.y(), q.z();
  }
  const Vector3d astray = noise.normal(1.0);
  if (noise.happens(options.outlier_share)) reading.position_m += options.outlier_m * astray.normalized();
  if (noise.happens(options.missing_share)) reading = SensorReading{};
  return reading;
}

}  // namespace

void VirtualTrackerOptions::validate() const {
  const auto require = [](bool good, const char* field, double value, const char* range) {
    if (!good) throw InputError(fmt::format("{} = {}: expected {}", field, value, range));
  };
  require(rate_hz > 0.0 && rate_hz <= 1e4, "rate_hz", rate_hz, "more than 0, at most 10000");
  require(duration_s > 0.0 && duration_s <= 86400.0, "duration_s", duration_s, "more than 0, at most 86400");
  require(missing_share >= 0.0 && missing_share < 1.0, "missing_share", missing_share, "0 to below 1");
  require(outlier_share >= 0.0 && outlier_share < 1.0, "outlier_share", outlier_share, "0 to below 1");
}

VirtualRecording simulate_tracker(const Catheter& catheter, const ForceSchedule& force,
                                  const VirtualTrackerOptions& options) {
  options.validate();
  catheter.validate();
  std::vector<double> arc_lengths;
  for (const Sensor& sensor : catheter.sensors) arc_lengths.push_back(sensor.arc_length_m);
  const RodSolver solver(catheter.rod, arc_lengths, Accuracy::kReference);
  RodSolution<3> shape = solver.make_solution<3>();
  WeightWorkspace<3> workspace = make_weight_workspace<3>(solver);
  NoiseSource noise(options.seed);

  VirtualRecording recording;
  const Pose& T_tracker_base = catheter.base.T_tracker_base;
  const auto frames = static_cast<std::int64_t>(std::llround(options.duration_s * options.rate_hz));
  for (std::int64_t number = 0; number < frames; ++number) {
    TrackerFrame frame{.time_s = static_cast<double>(number) / options.rate_hz, .number = number};
    const TipLoad load{.force_tip_N = force(frame.time_s)};
    if (!solve_under_weight(solver, load, LoadDirections<3>{}, workspace, shape).converged)
      throw InputError(fmt::format("force at {} s: no equilibrium found under the rod's own weight", frame.time_s));
    for (std::size_t i = 0; i < catheter.sensors.size(); ++i) {
      const Sensor& sensor = catheter.sensors[i];
      const Pose& T_own_base = catheter.T_tracker_base(sensor);
      const Pose T = T_own_base * shape.points[i].T_base_local * sensor.T_local_sensor;
      frame.readings.push_back(read_sensor(sensor, T, T_own_base.R, options, noise));
    }
    if (catheter.base.tracked) {
      const Sensor& base = catheter.base.sensor;
      frame.readings.push_back(
          read_sensor(base, T_tracker_base * base.T_local_sensor, T_tracker_base.R, options, noise));
    }
    recording.frames.push_back(std::move(frame));
    recording.force_tip_N.push_back(load.force_tip_N);
    recording.force_base_N.emplace_back(shape.T_base_tip.R * load.force_tip_N);
  }
  return recording;
}

Vector3d beating_wall_force(double time_s) {
  constexpr double kHeartHz = 1.2, kBreathingHz = 0.25;
  const double in_contact = std::fmod(time_s, 10.0) < 8.0 ? 1.0 : 0.0;
  const double heart = std::sin(2.0 * std::numbers::pi * kHeartHz * time_s);
  const double breathing = std::sin(2.0 * std::numbers::pi * kBreathingHz * time_s);
  const double press = in_contact * std::max(0.0, 0.08 + 0.045 * heart + 0.02 * breathing);
  return press * Vector3d(0.25 + 0.1 * breathing, 0.3, -0.9);
}

ForceSchedule turning_force(double size_N, double period_s) {
  return [=](double time_s) -> Vector3d {
    const double angle = 2.0 * std::numbers::pi * time_s / period_s;
    return size_N * Vector3d(0.0, std::sin(angle), -std::cos(angle));
  };
}

}  // namespace palpate
