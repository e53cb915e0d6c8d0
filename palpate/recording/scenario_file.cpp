// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/scenario_file.hpp>
#include <palpate/recording/scenario_load.hpp>
#include <palpate/recording/scenario_signals.hpp>
#include <palpate/recording/scenario_tracker.hpp>
#include <palpate/recording/scenario_truth.hpp>
#include <palpate/simulation/situation.hpp>

namespace palpate {
namespace {

constexpr NumberRange kDuration_s = {1e-3, 86400.0, "a time in seconds, 0.001..86400"};
constexpr NumberRange kSeed = {0.0, 9007199254740992.0, "a whole number, 0..2^53"};
constexpr NumberRange kPercent = {0.0, 100.0, "percent, 0..100"};
constexpr NumberRange kFlow_N = {0.0, 10.0, "a force in N, 0..10"};
constexpr NumberRange kMemory_s = {1e-4, 1000.0, "a time in seconds, 0.0001..1000"};
constexpr SignalUnit kMoment = {{-10.0, 10.0, "a moment in N m, at most 10"}, 1.0};
constexpr SignalUnit kBend = {{-500.0, 500.0, "a curvature in 1/m, at most 500"}, 1.0};
constexpr SignalUnit kKnob = {{-100.0, 100.0, "an angle in rad, at most 100"}, 1.0};
constexpr SignalUnit kTwist = {{-3600.0, 3600.0, "an angle in degrees, at most 3600"}, kRadiansPerDegree};
constexpr SignalUnit kTranslation = {{-1000.0, 1000.0, "a way in mm, at most 1000"}, kMetresPerMillimetre};
constexpr SignalUnit kFactor = {{0.05, 20.0, "a factor of the stiffness, 0.05..20"}, 1.0};

/// Beside the scenario, where the path is relative.
std::filesystem::path find_catheter(const TomlTable& table, const std::filesystem::path& scenario) {
  std::filesystem::path path = scenario.parent_path() / table.text("catheter");
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    table.refuse("catheter", fmt::format("a catheter file; there is no file {}", path.string()));
  return path;
}

void read_head(const TomlTable& table, const ScenarioChanges& changes, const std::string& stem, Scenario& scenario) {
  scenario.name = table.text("name", stem);
  scenario.duration_s = table.number("duration_s", kDuration_s, scenario.duration_s);
  if (const auto seed = table.optional_number("seed", kSeed)) {
    if (!table.find("seed")->is_integer()) table.refuse("seed", kSeed.expectation);
    scenario.seed = static_cast<std::uint64_t>(*seed);
  }
  scenario.seed = changes.seed.value_or(scenario.seed);
  scenario.duration_s = changes.duration_s.value_or(scenario.duration_s);
}

void read_flow(const TomlTable& root, Flow& flow) {
  const auto table = root.table("flow", {"rms_N", "memory_s"});
  if (!table) return;
  flow.rms_N = table->number("rms_N", kFlow_N);
  flow.memory_s = table->number("memory_s", kMemory_s, flow.memory_s);
}

/// Whoever steers in flowing blood knows that it flows: without it the filter would take the flow for tissue.
void put_flow(const Flow& flow, TomlEdit& edit) {
  if (flow.rms_N == 0.0 || edit.has("estimator", 0, "disturbance_rms_N")) return;
  edit.set("estimator", "disturbance_rms_N", toml_number(flow.rms_N));
  edit.set("estimator", "disturbance_memory_s", toml_number(std::max(flow.memory_s, 1e-3)));
}

/// The catheter file with what the tracker's sensors are in this scenario, and how its liquid flows.
void read_believed(const std::filesystem::path& path, const ScenarioTracker& tracker, ScenarioFile& file) {
  file.believed = read_catheter_file(path);
  TomlEdit edit(path);
  put_sensors(tracker, file.believed.catheter, edit);
  put_flow(file.scenario.flow, edit);
  edit.add_heading(
      fmt::format("What is believed of the catheter of the virtual experiment \"{}\".", printable(file.scenario.name)));
  file.believed = parse_catheter({.name = path.string(), .lines = edit.lines()});
  file.believed_text = edit.text();
}

void read_handle(const TomlTable& root, Scenario& scenario) {
  const auto table = root.table(
      "handle", {"moment_1_Nm", "moment_sigma_percent", "bend_1_per_m", "knob_rad", "twist_deg", "translation_mm"});
  if (!table) return;
  HandleMotion& handle = scenario.handle;
  handle.tendon = table->has("moment_1_Nm");
  const TendonMap& map = scenario.catheter.tendon_map;
  if (handle.tendon && !scenario.catheter.tendon.present)
    table->refuse("moment_1_Nm", "a catheter file with [tendon], which says how the moment acts");
  if (table->has("knob_rad") && !(map.present && map.input == TendonInput::kKnob))
    table->refuse("knob_rad", "a catheter file with [tendon_map] of input \"knob_rad\"");
  if (table->has("moment_sigma_percent") && !handle.tendon)
    table->refuse("moment_sigma_percent", "this key only together with moment_1_Nm");
  handle.moment_1_Nm = read_signal(*table, "moment_1_Nm", kMoment, {});
  handle.moment_sigma_fraction = 0.01 * table->number("moment_sigma_percent", kPercent, 0.0);
  handle.bend_1_per_m = read_signal(*table, "bend_1_per_m", kBend, {});
  handle.knob_rad = read_signal(*table, "knob_rad", kKnob, {});
  // A knob that stays at zero bends as the map says there; without a signal there would be no knob at all.
  if (table->has("knob_rad") && !has_knob(handle)) handle.knob_rad.points = {{0.0, 0.0}};
  handle.twist_rad = read_signal(*table, "twist_deg", kTwist, {});
  handle.translation_m = read_signal(*table, "translation_mm", kTranslation, {});
}

/// The sum of its parts may leave the range that each keeps.
void read_stiffness(const TomlTable& root, Scenario& scenario) {
  const auto table = root.table("stiffness", {"factor"});
  if (!table) return;
  scenario.stiffness_factor = read_signal(*table, "factor", kFactor);
  constexpr int kSamples = 1000;
  for (int i = 0; i <= kSamples; ++i) {
    const double time_s = scenario.duration_s * i / kSamples, factor = scenario.stiffness_factor.at(time_s);
    if (!(factor >= kFactor.range.least && factor <= kFactor.range.most))
      table->refuse("factor", fmt::format("{}, at all times, here {:.4g} at {:.4g} s", kFactor.range.expectation,
                                          factor, time_s));
  }
}

/// Whoever draws a world from the catheter file's sigmas draws the tracker's accuracy from them, too.
void draw_bias(const Catheter& believed, TrackerErrors& errors) {
  for (const Sensor& sensor : believed.sensors) {
    errors.bias_m = std::max(errors.bias_m, sensor.bias_m);
    errors.bias_rad = std::max(errors.bias_rad, sensor.bias_rad);
  }
  errors.bias_length_m = believed.bias_length_m;
}

ScenarioFile read_root(const TomlTable& root, const std::filesystem::path& path, const ScenarioChanges& changes) {
  root.number("schema", {1.0, 1.0, "1, the schema this program reads"});
  const auto head = root.table("scenario", {"name", "catheter", "duration_s", "seed"});
  if (!head) root.refuse("scenario", "a table [scenario] with catheter and duration_s");
  ScenarioFile file;
  Scenario& scenario = file.scenario;
  read_head(*head, changes, path.stem().string(), scenario);
  const ScenarioTracker tracker = read_tracker(root);
  read_flow(root, scenario.flow);
  file.catheter_path = find_catheter(*head, path);
  read_believed(file.catheter_path, tracker, file);
  bool drawn = false;
  scenario.catheter = read_truth(root, file.believed.catheter, scenario.seed, drawn);
  scenario.tracker = tracker.errors;
  scenario.tracker.rate_hz = changes.rate_hz.value_or(scenario.tracker.rate_hz);
  if (drawn && !tracker.bias_given) draw_bias(file.believed.catheter, scenario.tracker);
  read_handle(root, scenario);
  read_stiffness(root, scenario);
  if (tracker.noise_free || changes.noise_free) silence(scenario);
  read_load(root, scenario);
  return file;
}

}  // namespace

ScenarioFile read_scenario_file(const std::filesystem::path& path, const ScenarioChanges& changes) {
  const TextFile text = read_text_file(path);
  const toml::table table = parse_toml(text);
  const TomlTable root(table, "", text.name,
                       {"schema", "scenario", "truth", "load", "handle", "flow", "stiffness", "tracker"});
  ScenarioFile file = read_root(root, path, changes);
  try {
    file.scenario.validate();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", text.name, error.what()));
  }
  return file;
}

}  // namespace palpate
