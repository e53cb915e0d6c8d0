// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <palpate/math/errors.hpp>
#include <palpate/recording/scenario_file.hpp>
#include <palpate/simulation/virtual_run.hpp>

#include "arrays.hpp"
#include "bindings.hpp"

namespace palpate::python {
namespace {

ScenarioChanges changes_of(const py::object& seed, const py::object& duration_s, const py::object& rate_hz,
                           bool noise_free) {
  ScenarioChanges changes{.noise_free = noise_free};
  const auto within = [](const py::object& value, const char* name, double least, double most) {
    const double out = number(value, name);
    if (!(out >= least && out <= most))
      throw InputError(fmt::format("{} = {}: expected {} to {}", name, out, least, most));
    return out;
  };
  if (!seed.is_none()) {
    const long whole = whole_number(seed, "seed");
    if (whole < 0 || whole > (1L << 53U))
      throw InputError(fmt::format("seed = {}: expected a whole number, 0 to 2^53", whole));
    changes.seed = static_cast<std::uint64_t>(whole);
  }
  if (!duration_s.is_none()) changes.duration_s = within(duration_s, "duration_s", 1e-3, 86400.0);
  if (!rate_hz.is_none()) changes.rate_hz = within(rate_hz, "rate_hz", 1e-3, 1e4);
  return changes;
}

py::dict truth_columns(const std::vector<Truth>& truth) {
  const std::size_t n = truth.size();
  const auto vectors = [&](auto get) {
    return filled(n, {3}, [&](std::size_t i, double* to) { put_rows(get(truth[i]), to); });
  };
  py::dict out;
  out["time_s"] = filled(n, {}, [&](std::size_t i, double* to) { *to = truth[i].time_s; });
  out["force_tip_N"] = vectors([](const Truth& t) { return t.force_tip_N; });
  out["force_base_N"] = vectors([](const Truth& t) { return t.force_base_N; });
  out["stiffness_Nm2"] = vectors([](const Truth& t) { return t.stiffness_Nm2; });
  out["precurvature_per_m"] = vectors([](const Truth& t) { return t.precurvature_per_m; });
  out["p_base_tip_m"] = vectors([](const Truth& t) { return t.T_base_tip.p; });
  out["R_base_tip"] = filled(n, {3, 3}, [&](std::size_t i, double* to) { put_rows(truth[i].T_base_tip.R, to); });
  out["in_contact"] = filled<bool>(n, {}, [&](std::size_t i, bool* to) { *to = truth[i].in_contact; });
  return out;
}

/// As the reader of a tracker CSV names them: the shaft's sensors, a tracked base last.
Recording recording_of(std::vector<TrackerFrame> frames, const Catheter& believed, const std::string& source) {
  Recording out;
  out.data.source = source;
  for (const Sensor& sensor : believed.sensors) out.data.sensor_names.push_back(sensor.name);
  if (believed.base.tracked) out.data.sensor_names.push_back(believed.base.sensor.name);
  out.data.sensor_lines.assign(out.data.sensor_names.size(), 0);
  out.data.frames = std::move(frames);
  return out;
}

py::tuple simulate(const py::object& path, const py::object& seed, const py::object& duration_s,
                   const py::object& rate_hz, bool noise_free, bool stable_only) {
  const std::string source = path_text(path, "scenario");
  const ScenarioChanges changes = changes_of(seed, duration_s, rate_hz, noise_free);
  ScenarioFile file;
  VirtualRun run;
  {
    const OthersRun others_run;
    file = read_scenario_file(source, changes);
    try {
      run = run_scenario(file.scenario, {.stable_only = stable_only});
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", source, error.what()));
    }
  }
  if (run.frames.empty()) throw InputError(fmt::format("{}: expected long enough for a frame", source));
  std::vector<std::pair<double, std::string>> events;
  for (const ScenarioEvent& event : run.events) events.emplace_back(event.time_s, event.what);
  Recording recording = recording_of(std::move(run.frames), file.believed.catheter, source);
  return py::make_tuple(std::move(recording), truth_columns(run.truth), std::move(file.believed), file.believed_text,
                        events);
}

}  // namespace

void bind_simulation(py::module_& m) { m.def("simulate", &simulate); }

}  // namespace palpate::python
