// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <palpate/math/errors.hpp>
#include <palpate/recording/tracker_recording.hpp>

#include "file_paths.hpp"
#include "identify_files.hpp"
#include "identify_noise_report.hpp"
#include "time_span.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

struct Options {
  std::string recording, catheter, interval;
  std::string out, plot;
  bool moving = false, json = false;
};

NoiseInterval chosen_interval(const Options& options, const TrackerRecording& recording) {
  NoiseInterval interval;
  if (!options.interval.empty()) {
    const TimeSpan span = parse_time_span("--interval", options.interval);
    interval = {span.from_s, span.to_s};
  }
  const auto inside = [&](const TrackerFrame& f) { return f.time_s >= interval.from_s && f.time_s <= interval.to_s; };
  if (recording.frames.empty()) throw InputError(fmt::format("{}: expected at least one frame", recording.source));
  if (std::none_of(recording.frames.begin(), recording.frames.end(), inside))
    throw InputError(
        fmt::format("{}: no frame between {} s and {} s: expected an interval with frames; the recording "
                    "goes from {} s to {} s",
                    recording.source, interval.from_s, interval.to_s, recording.frames.front().time_s,
                    recording.frames.back().time_s));
  return interval;
}

const Sensor* find_sensor(const std::vector<const Sensor*>& sensors, const std::string& name) {
  for (const Sensor* sensor : sensors)
    if (sensor->name == name) return sensor;
  return nullptr;
}

void refuse_if_nothing_told(const NoiseReport& report) {
  std::string reasons;
  for (const SensorNoise& s : report.sensors) {
    if (s.untold().empty()) return;
    reasons += fmt::format("{}sensor \"{}\": {}", reasons.empty() ? "" : "; ", s.name, s.untold());
  }
  throw InputError(fmt::format("{}: no sensor tells its noise: {}", report.source, reasons));
}

NoiseReport identify(const Options& options, const TrackerRecording& recording,
                     const std::vector<const Sensor*>& sensors) {
  NoiseReport report{.source = recording.source, .moving = options.moving};
  const NoiseInterval interval = chosen_interval(options, recording);
  for (std::size_t i = 0; i < recording.sensor_names.size(); ++i) {
    SensorNoise& found = report.sensors.emplace_back();
    found.name = recording.sensor_names[i];
    found.sensor = find_sensor(sensors, found.name);
    const SensorSamples samples = collect_samples(recording.frames, i, interval);
    if (options.moving)
      found.moving = identify_moving_noise(samples);
    else
      found.rest = identify_rest_noise(samples);
  }
  refuse_if_nothing_told(report);
  return report;
}

/// The model has one sigma of the orientation for all axes that are measured: that of the worst.
double worst_turn_rad(const SensorNoise& s) {
  const Vector3d variance = s.rotation_rad2();
  return std::sqrt(s.sensor->kind == SensorKind::kPose5 ? variance.head<2>().maxCoeff() : variance.maxCoeff());
}

void put(const SensorNoise& s, const Catheter& catheter, const std::string& comment, TomlEdit& edit) {
  const SensorPlace place = place_of(edit, *s.sensor);
  const auto set = [&](const char* key, const std::string& value) {
    edit.set(place.table, place.index, key, value, comment);
  };
  // Base axes are fixed in the tracker only where the base is; else one figure has to do, that of the worst axis.
  const bool fixed = !catheter.base.tracked || s.sensor->T_tracker_base;
  const Matrix3d R = fixed ? catheter.T_tracker_base(*s.sensor).R : Matrix3d::Identity();
  const Vector3d sigma_mm = (R.transpose() * s.position_m2() * R).diagonal().cwiseSqrt() * kMillimetresPerMetre;
  edit.remove(place.table, place.index, fixed ? "noise_mm" : "noise_axes_mm");
  if (fixed)
    set("noise_axes_mm", toml_array({sigma_mm.x(), sigma_mm.y(), sigma_mm.z()}, 4));
  else
    set("noise_mm", toml_number(sigma_mm.maxCoeff(), 4));
  const bool turns = s.rest ? s.rest->has_orientation : s.moving->has_orientation;
  if (turns && s.sensor->kind != SensorKind::kPosition)
    set("noise_deg", toml_number(worst_turn_rad(s) / kRadiansPerDegree, 4));
}

/// What does not stand is refused where it was said to rest, and left out where it moves.
bool is_written(const SensorNoise& s) {
  return s.sensor != nullptr && s.untold().empty() && (s.rest || s.moving->holds());
}

TomlEdit edited(const Options& options, const Catheter& catheter, const NoiseReport& report) {
  if (std::none_of(report.sensors.begin(), report.sensors.end(), is_written))
    throw InputError(fmt::format("{}: tells the noise of no sensor of the catheter {}: {}", report.source,
                                 options.catheter,
                                 report.moving ? "expected slower, smoother motion" : "expected its sensors at rest"));
  TomlEdit edit(options.catheter);
  for (const SensorNoise& s : report.sensors) {
    if (!is_written(s)) continue;
    if (s.rest && !s.stands())
      throw InputError(
          fmt::format("{}: sensor \"{}\" does not rest: expected a recording at rest (choose a part with "
                      "--interval), or --moving; no catheter file is written",
                      report.source, s.name));
    const std::size_t used = s.rest ? s.rest->used : s.moving->used;
    put(s, catheter,
        fmt::format("identified {}: +- {:.2g} %, {} readings", report.moving ? "moving" : "at rest",
                    100.0 * s.sigma_fraction(), used),
        edit);
  }
  parse_catheter({.name = options.out, .lines = edit.lines()});
  return edit;
}

void warn_of_absent_sensors(const NoiseReport& report, const std::vector<const Sensor*>& sensors,
                            std::vector<std::string>& warnings) {
  for (const Sensor* sensor : sensors)
    if (std::none_of(report.sensors.begin(), report.sensors.end(), [&](const auto& s) { return s.sensor == sensor; }))
      warnings.push_back(
          fmt::format("{}: has no sensor \"{}\", which keeps the noise it had", report.source, sensor->name));
}

int run(const Options& options) {
  std::vector<InputPath> inputs{{"recording", "the recording", options.recording}};
  if (!options.catheter.empty()) inputs.push_back({"--catheter", "the catheter file", options.catheter});
  check_paths(inputs, {{"--out", options.out}, {"--plot", options.plot}});
  std::optional<CatheterFile> file;
  if (!options.catheter.empty()) file = read_catheter_file(options.catheter);
  std::vector<std::string> warnings = file ? file->warnings : std::vector<std::string>{};
  const std::vector<const Sensor*> sensors = file ? all_sensors(file->catheter) : std::vector<const Sensor*>{};
  const TrackerRecording recording =
      read_tracker_recording(options.recording, {.catheter = file ? &file->catheter : nullptr, .one_of_several = true});
  for (const std::string& note : recording.notes) warnings.push_back(fmt::format("{}: {}", recording.source, note));
  NoiseReport report = identify(options, recording, sensors);
  for (std::string& warning : warnings_of(report)) warnings.push_back(std::move(warning));
  warn_of_absent_sensors(report, sensors, warnings);
  std::optional<TomlEdit> edit;
  report.out = options.out;
  if (!report.out.empty()) edit = edited(options, file->catheter, report);
  const auto plot = [&] {
    if (!options.plot.empty()) report.plot(options.plot);
  };
  edit ? write_catheter_file(*edit, report.out, plot) : plot();
  print_warnings(warnings);
  options.json ? report.print_json() : report.print();
  const bool any = std::any_of(report.sensors.begin(), report.sensors.end(), [](const auto& s) { return s.stands(); });
  return any ? 0 : 1;
}

}  // namespace

void add_identify_noise(CLI::App& identify, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = identify.add_subcommand(
      "noise", "What the sensors' noise is, from a recording at rest or of smooth motion: precision, not accuracy");
  verb->add_option("recording", options->recording, "of any format that palpate estimate reads")
      ->type_name("FILE")
      ->required();
  CLI::Option* catheter =
      verb->add_option("--catheter", options->catheter, "catheter file (TOML) to start from")->type_name("FILE");
  verb->add_option("--out", options->out, "catheter file to write, with the noise found")
      ->type_name("FILE")
      ->needs(catheter);
  verb->add_option("--interval", options->interval, "seconds: the part to use")->type_name("FROM:TO");
  verb->add_flag("--moving", options->moving,
                 "the sensors move smoothly: noise from what a Kalman filter cannot predict");
  verb->add_option("--plot", options->plot, "draw deviations and Allan deviation, or innovations (.svg or .png)")
      ->type_name("FILE");
  verb->add_flag("--json", options->json, "print the figures as JSON");
  verb->footer(
      "Example: palpate identify noise rest.tracker.csv\n"
      "         palpate identify noise rest.tracker.csv --catheter catheter.toml --out identified.toml --plot "
      "noise.svg\n"
      "         palpate identify noise sweep.tracker.csv --moving --interval 2:30");
  verb->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace palpate::app
