// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>
#include <palpate/reproduction/experiment_scenarios.hpp>
#include <palpate/reproduction/paper_catheter.hpp>

namespace palpate::reproduction {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kAccuracy_m = 0.48e-3, kAccuracy_rad = 0.3 * kRadiansPerDegree;  // as the paper states it

Vector3d unloaded_tip_m(double k) { return {0.0, -(1.0 - std::cos(k * kLength_m)) / k, std::sin(k * kLength_m) / k}; }

/// Curve of a point that `where` gives, as the signals of its coordinates.
template <class Where>
Signal3 followed(const Where& where, double duration_s) {
  constexpr double kStep_s = 0.1;
  Signal3 signals;
  const auto steps = static_cast<int>(std::lround(duration_s / kStep_s));
  for (int i = 0; i <= steps; ++i) {
    const Vector3d p = where(i * kStep_s);
    for (std::size_t axis = 0; axis < 3; ++axis)
      signals[axis].points.emplace_back(i * kStep_s, p(static_cast<Eigen::Index>(axis)));
  }
  for (Signal& s : signals) s.course = Signal::Course::kSmooth;
  return signals;
}

/// A pulley on two links about the unloaded tip: `turn` in the plane of the bend, `tilt` out of it, from -e2.
Load weight_on(double k, double duration_s, double turn_rad, double tilt_rad) {
  constexpr double kReach_m = 0.15, kTurn_s = 10.0, kTilt_s = 14.0, kGram = 1e-3;
  const Vector3d tip = unloaded_tip_m(k);
  const auto pulley = [=](double t) -> Vector3d {
    const double turn = turn_rad * std::sin(kTwoPi * t / kTurn_s), tilt = tilt_rad * std::sin(kTwoPi * t / kTilt_s);
    return tip + kReach_m * Vector3d(std::sin(tilt), -std::cos(tilt) * std::cos(turn), std::cos(tilt) * std::sin(turn));
  };
  return PulleyLoad{.mass_kg = 13.03 * kGram, .pulley_base_m = followed(pulley, duration_s)};
}

/// A stiff plate (the force sensor) that faces the tip, a millimetre away from it, and comes towards the clamp.
WallLoad plate(double k) {
  const Vector3d normal = Vector3d(0.3, 0.7, -0.65).normalized();
  WallLoad wall;
  wall.point_base_m = unloaded_tip_m(k) - 1e-3 * normal;
  wall.normal_base = normal;
  wall.stiffness_N_per_m = 1e4;
  wall.tangential_stiffness_N_per_m = 1e3;
  wall.friction = 1.0;  // seated in the sensor: it does not slip
  return wall;
}

Load by_hand(double k) {
  constexpr double kMove_s = 2.0, kHold_s = 3.0;
  constexpr std::array kDepths_mm = {1.2, 1.5, 1.8, 2.1, 2.4, 1.9, 1.4};
  WallLoad wall = plate(k);
  wall.along_normal_m.course = Signal::Course::kSmooth;
  wall.along_normal_m.points = {{0.0, 0.0}};
  double t = 1.0;
  for (const double depth_mm : kDepths_mm) {
    wall.along_normal_m.points.emplace_back(t, depth_mm * kMetresPerMillimetre);
    wall.along_normal_m.points.emplace_back(t + kHold_s, depth_mm * kMetresPerMillimetre);
    t += kHold_s + kMove_s;
  }
  return wall;
}

Load by_motors(double k) {
  WallLoad wall = plate(k);
  wall.along_normal_m.constant = 1.7e-3;
  wall.along_normal_m.sines = {{.amplitude = 0.5e-3, .frequency_hz = 0.21, .phase_rad = -kTwoPi / 4.0}};
  wall.along_normal_m.points = {{0.0, -1e-3}, {1.0, 0.0}};  // brought up within the second that is not judged
  return wall;
}

Load load_of(ExperimentId id) {
  const Experiment& e = experiment(id);
  const double k = e.precurvature_per_m;
  switch (id) {
    case ExperimentId::kIa:
      return weight_on(k, e.duration_s, 70.0 * kRadiansPerDegree, 0.0);
    case ExperimentId::kIb:
      return weight_on(k, e.duration_s, 40.0 * kRadiansPerDegree, 50.0 * kRadiansPerDegree);
    case ExperimentId::kIIa:
      return by_hand(k);
    case ExperimentId::kIIb:
      break;
  }
  return by_motors(k);
}

}  // namespace

std::string_view describe(AuroraReading reading) {
  switch (reading) {
    case AuroraReading::kWhite:
      return "0.28 mm, 0.17 deg white";
    case AuroraReading::kAtRest:
      return "0.03 mm, 0.06 deg white";
    case AuroraReading::kBiased:
      break;
  }
  return "0.03 mm, 0.06 deg white; 0.48 mm, 0.3 deg over space";
}

Catheter experiment_catheter(ExperimentId id, AuroraReading reading) {
  Catheter catheter = paper_catheter(experiment(id).precurvature_per_m);
  const bool white = reading == AuroraReading::kWhite, biased = reading == AuroraReading::kBiased;
  for (Sensor& sensor : catheter.sensors) {
    sensor.noise_m.setConstant((white ? 0.28 : 0.03) * kMetresPerMillimetre);
    sensor.noise_rad = (white ? 0.17 : 0.06) * kRadiansPerDegree;
    if (biased) sensor.bias_m = kAccuracy_m, sensor.bias_rad = kAccuracy_rad;
  }
  if (experiment(id).with_stiffness) catheter.stiffness_sigma_fraction = 0.05;
  return catheter;
}

Scenario experiment_scenario(ExperimentId id, AuroraReading reading, int repeat) {
  const Experiment& e = experiment(id);
  Scenario s;
  s.name = "Experiment " + std::string(e.name);
  s.catheter = experiment_catheter(id, reading);
  s.duration_s = e.duration_s;
  s.seed = 100 * static_cast<std::uint64_t>(id) + static_cast<std::uint64_t>(repeat) + 1;
  s.load = load_of(id);
  if (e.water) s.flow = {.rms_N = 0.5e-3, .memory_s = 0.3};
  s.tracker.rate_hz = e.rate_hz;
  if (reading == AuroraReading::kBiased) s.tracker.bias_m = kAccuracy_m, s.tracker.bias_rad = kAccuracy_rad;
  return s;
}

double stated_pace(const Experiment& experiment) {
  return experiment.swing_N * std::pow(experiment.swing_rad_per_s, 1.5) / std::numbers::sqrt2;
}

ObserverOptions experiment_options(ExperimentId id, Method method) {
  ObserverOptions options;
  options.method = method;
  options.estimate_stiffness = experiment(id).with_stiffness;
  return options;
}

}  // namespace palpate::reproduction
