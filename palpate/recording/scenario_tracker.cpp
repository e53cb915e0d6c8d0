// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <palpate/math/units.hpp>
#include <palpate/recording/scenario_tracker.hpp>

namespace palpate {
namespace {

constexpr NumberRange kRate_hz = {1e-3, 1e4, "frames a second in Hz, 0.001..10000"};
constexpr NumberRange kNoise_mm = {1e-9, 50.0, "a standard deviation in mm, more than 0, at most 50 (or noise_free)"};
constexpr NumberRange kNoise_deg = {1e-9, 90.0, "a standard deviation in degrees, more than 0, at most 90"};
constexpr NumberRange kBias_mm = {0.0, 100.0, "an rms error in mm, 0..100"};
constexpr NumberRange kBias_deg = {0.0, 90.0, "an rms error in degrees, 0..90"};
constexpr NumberRange kBiasLength_mm = {1.0, 1e6, "a length in mm, 1..1e6"};
constexpr NumberRange kStep_mm = {0.0, 10.0, "a step in mm, 0..10"};
constexpr NumberRange kStep = {0.0, 0.1, "a step of the quaternion's components, 0..0.1"};
constexpr NumberRange kLatency_s = {0.0, 100.0, "a time in seconds, 0..100"};
constexpr NumberRange kJitter_s = {0.0, 10.0, "a standard deviation in seconds, 0..10"};
constexpr NumberRange kPercent = {0.0, 99.0, "percent, 0..99"};
constexpr NumberRange kOutlier_mm = {0.0, 1e4, "a distance in mm, 0..10000"};
constexpr NumberRange kDof = {5.0, 6.0, "5 or 6"};

constexpr double kNoNoise = 1e-12;  // what a catheter may state as its least; far below any file's last digit

void quieten(Sensor& sensor) {
  sensor.noise_m.setConstant(kNoNoise);
  sensor.noise_rad = kNoNoise;
}

TrackerErrors read_errors(const TomlTable& table) {
  TrackerErrors e;
  const auto mm = [&](const char* key, const NumberRange& range, double otherwise_m) {
    return table.number(key, range, otherwise_m * kMillimetresPerMetre) * kMetresPerMillimetre;
  };
  const auto share = [&](const char* key) { return 0.01 * table.number(key, kPercent, 0.0); };
  e.rate_hz = table.number("rate_hz", kRate_hz, e.rate_hz);
  e.bias_m = mm("bias_mm", kBias_mm, e.bias_m);
  e.bias_rad = table.number("bias_deg", kBias_deg, 0.0) * kRadiansPerDegree;
  e.bias_length_m = mm("bias_length_mm", kBiasLength_mm, e.bias_length_m);
  e.position_step_m = mm("position_step_mm", kStep_mm, e.position_step_m);
  e.quaternion_step = table.number("quaternion_step", kStep, e.quaternion_step);
  e.latency_s = table.number("latency_s", kLatency_s, e.latency_s);
  e.jitter_s = table.number("jitter_s", kJitter_s, e.jitter_s);
  e.missing_share = share("missing_percent");
  e.dropped_share = share("dropped_percent");
  e.outlier_share = share("outlier_percent");
  e.outlier_m = mm("outlier_mm", kOutlier_mm, e.outlier_m);
  return e;
}

/// Beside noise_free stands the rate, and what kind the sensors are.
void refuse_errors(const TomlTable& table) {
  for (const char* key :
       {"noise_mm", "noise_deg", "bias_mm", "bias_deg", "bias_length_mm", "position_step_mm", "quaternion_step",
        "latency_s", "jitter_s", "missing_percent", "dropped_percent", "outlier_percent", "outlier_mm"})
    if (table.has(key)) table.refuse(key, "no such key beside noise_free = true");
}

}  // namespace

ScenarioTracker read_tracker(const TomlTable& root) {
  const auto table =
      root.table("tracker", {"rate_hz", "noise_free", "noise_mm", "noise_deg", "dof", "bias_mm", "bias_deg",
                             "bias_length_mm", "position_step_mm", "quaternion_step", "latency_s", "jitter_s",
                             "missing_percent", "dropped_percent", "outlier_percent", "outlier_mm"});
  ScenarioTracker tracker;
  if (!table) return tracker;
  tracker.noise_free = table->flag("noise_free", false);
  if (tracker.noise_free) refuse_errors(*table);
  tracker.errors = read_errors(*table);
  tracker.bias_given = table->has("bias_mm") || table->has("bias_deg");
  tracker.noise_mm = table->optional_number("noise_mm", kNoise_mm);
  tracker.noise_deg = table->optional_number("noise_deg", kNoise_deg);
  if (table->has("dof")) tracker.dof = table->integer("dof", kDof, 6);
  return tracker;
}

void put_sensors(const ScenarioTracker& tracker, const Catheter& catheter, TomlEdit& edit) {
  const std::vector<std::string> names = edit.names("sensor");
  const auto put = [&](const Sensor& sensor, bool on_shaft) {
    const auto found = std::find(names.begin(), names.end(), sensor.name);
    const bool listed = found != names.end();  // else [base] describes it
    const char* where = listed ? "sensor" : "base";
    const std::size_t index = listed ? static_cast<std::size_t>(found - names.begin()) : 0;
    const auto set = [&](const char* key, const std::string& value) {
      listed ? edit.set(where, index, key, value) : edit.set(where, key, value);
    };
    if (tracker.noise_mm) {
      listed ? edit.remove(where, index, "noise_axes_mm") : edit.remove(where, "noise_axes_mm");
      set("noise_mm", toml_number(*tracker.noise_mm));
    }
    if (tracker.noise_deg) set("noise_deg", toml_number(*tracker.noise_deg));
    if (tracker.dof && on_shaft && sensor.kind != SensorKind::kPosition)
      set("kind", *tracker.dof == 5 ? "\"pose5\"" : "\"pose\"");
  };
  for (const Sensor& sensor : catheter.sensors) put(sensor, true);
  if (catheter.base.tracked) put(catheter.base.sensor, false);
}

void silence(Scenario& scenario) {
  for (Sensor& sensor : scenario.catheter.sensors) quieten(sensor);
  quieten(scenario.catheter.base.sensor);
  scenario.handle.moment_sigma_fraction = 0.0;
  scenario.tracker = {.rate_hz = scenario.tracker.rate_hz};
}

}  // namespace palpate
