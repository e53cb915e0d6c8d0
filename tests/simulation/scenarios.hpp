// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <palpate/simulation/virtual_run.hpp>
#include <tests/sensing/virtual_setups.hpp>

/// Scenarios that several tests play, and what is read off a run.
namespace palpate::test {

inline Signal steady(double value) { return {.constant = value}; }
inline Signal3 steady(const Vector3d& v) { return {steady(v.x()), steady(v.y()), steady(v.z())}; }

/// From 0 to `value` over `duration_s`.
inline Signal ramp(double value, double duration_s) { return {.points = {{0.0, 0.0}, {duration_s, value}}}; }

/// Noise far below what any test looks at.
inline Catheter noiseless(Catheter catheter) {
  for (Sensor& sensor : catheter.sensors) sensor.noise_m.setConstant(1e-15), sensor.noise_rad = 1e-15;
  catheter.base.sensor.noise_m.setConstant(1e-15);
  catheter.base.sensor.noise_rad = 1e-15;
  return catheter;
}

inline Catheter straight(Catheter catheter) {
  catheter.rod.sections[0].precurvature_per_m.setZero();
  return catheter;
}

inline Scenario scenario_of(const Catheter& catheter, const Load& load, double duration_s = 1.0) {
  Scenario scenario;
  scenario.name = "test";
  scenario.catheter = noiseless(catheter);
  scenario.duration_s = duration_s;
  scenario.load = load;
  return scenario;
}

/// The first frame alone.
inline Truth first_truth(Scenario scenario) {
  scenario.duration_s = 1.0 / scenario.tracker.rate_hz;
  return run_scenario(scenario).truth.at(0);
}

inline double euler_load_N(const Rod& rod) {
  const Stiffness& K = rod.sections[0].stiffness_Nm2;
  return std::numbers::pi * std::numbers::pi * std::min(K(0), K(1)) / (4.0 * rod.length_m() * rod.length_m());
}

inline Vector3d contact_point(const Scenario& scenario, const Truth& truth) {
  return truth.T_base_tip * scenario.catheter.rod.contact_offset_m;
}

inline std::string refusal(const Scenario& scenario, const RunOptions& options = {}) {
  try {
    run_scenario(scenario, options);
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace palpate::test
