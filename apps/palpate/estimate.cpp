// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <palpate/identification/tare.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/estimate_csv.hpp>
#include <palpate/recording/tendon_csv.hpp>
#include <palpate/recording/tracker_recording.hpp>

#include "estimate_report.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

struct Options {
  std::string catheter, recording, out, tendon, method, state, measurement, reference, plot;
  bool smooth = false, strict = false, json = false;
};

void warn(const std::string& text) { fmt::print(stderr, "palpate: warning: {}\n", text); }

template <class Enum>
void choose(const std::string& flag, const std::string& value, std::initializer_list<std::pair<const char*, Enum>> known, Enum& out) {
  if (value.empty()) return;
  std::string names;
  for (const auto& [name, chosen] : known) {
    if (value == name) {
      out = chosen;
      return;
    }
    names += names.empty() ? name : std::string(", ") + name;
  }
  throw InputError(fmt::format("{} {}: expected one of {}", flag, value, names));
}

void apply_flags(const Options& options, ObserverOptions& observer) {
  choose<Method>("--method", options.method, {{"ekf", Method::kEkf}, {"iekf", Method::kIekf}, {"iaekf", Method::kIaekf}}, observer.method);
  choose<MeasurementKind>("--measurement", options.measurement,
                          {{"poses", MeasurementKind::kPoses}, {"tip_and_curvature", MeasurementKind::kTipAndCurvature}},
                          observer.measurement);
  if (!options.state.empty() && options.state != "force")
    throw InputError(fmt::format("--state {}: expected force; stiffness and precurvature are not estimated by this version", options.state));
  if (options.smooth) throw InputError("--smooth: not available in this version; leave it out for the online estimate");
  observer.report_convergence_index = true;
}

/// "FROM:TO" in seconds.
void parse_reference(const std::string& text, ReferenceInterval& reference) {
  if (text.empty()) return;
  const auto number = [&](std::string_view part) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size() || !std::isfinite(value))
      throw InputError(fmt::format("--reference {}: expected FROM:TO in seconds, as 0:2", text));
    return value;
  };
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) throw InputError(fmt::format("--reference {}: expected FROM:TO in seconds, as 0:2", text));
  reference.from_s = number(std::string_view(text).substr(0, colon));
  reference.to_s = number(std::string_view(text).substr(colon + 1));
  if (!(reference.to_s > reference.from_s))
    throw InputError(fmt::format("--reference {}: expected an end after the beginning", text));
  reference.given = true;
}

TrackerRecording load_recording(const Options& options, const CatheterFile& file) {
  TrackerRecording recording = read_tracker_recording(
      options.recording,
      {.catheter = &file.catheter, .reference_from_s = file.reference.from_s, .reference_to_s = file.reference.to_s});
  bind_to_catheter(recording, file.catheter, file.ignore_sensors);
  if (recording.frames.empty()) throw InputError(fmt::format("{}: expected at least one frame", options.recording));
  for (const std::string& note : recording.notes) warn(fmt::format("{}: {}", options.recording, note));
  return recording;
}

/// A recording in metres, or of another setup, keeps every sensor far from where the shaft could hold it.
void check_reach(const Catheter& catheter, const TrackerRecording& recording) {
  if (catheter.base.tracked) return;
  const double reach_m = 1.5 * (catheter.rod.length_m() + catheter.rod.rigid_tip_m) + 0.02 + 4.0 * catheter.base.position_sigma_m;
  for (std::size_t i = 0; i < catheter.sensors.size(); ++i) {
    double nearest_m = std::numeric_limits<double>::infinity(), spread_m = 0.0;
    for (const TrackerFrame& frame : recording.frames) {
      if (screen(frame.readings[i], catheter.sensors[i].kind) != Rejection::kNone) continue;
      nearest_m = std::min(nearest_m, (frame.readings[i].position_m - catheter.base.T_tracker_base.p).norm());
      spread_m = std::max(spread_m, frame.readings[i].position_m.norm());
    }
    if (!std::isfinite(nearest_m) || nearest_m <= reach_m) continue;
    throw InputError(fmt::format(
        "{}: sensor \"{}\": never nearer than {:.4g} mm to the base of the catheter file: expected at most {:.4g} mm; {}",
        recording.source, catheter.sensors[i].name, nearest_m * kMillimetresPerMetre, reach_m * kMillimetresPerMetre,
        spread_m < 2e-3 ? "are the positions in metres instead of millimetres?" : "is [base] that of this setup?"));
  }
}

void attach_tendon(const std::string& path, const Catheter& catheter, TrackerRecording& recording) {
  if (path.empty()) return;
  if (!catheter.tendon.present)
    throw InputError(fmt::format("--tendon {}: the catheter file has no [tendon]: expected its model", path));
  const TendonTrace trace = read_tendon_csv(path, catheter.tendon);
  std::size_t outside = 0;
  for (TrackerFrame& frame : recording.frames) {
    if (!std::isfinite(frame.time_s)) continue;
    const TendonTrace::Sample sample = trace.interpolate(frame.time_s);
    outside += sample.inside ? 0 : 1;
    frame.tendon = {.present = true, .moment_Nm = sample.moment_Nm, .sigma_Nm = sample.sigma_Nm};
  }
  if (outside > 0) warn(fmt::format("{}: {} frames lie outside its time span: the nearest moment was taken", path, outside));
  warn(fmt::format("{}: the moment is used as a known load; its sigma does not widen the force's yet", path));
}

/// --strict: whatever would be passed over in silence is an error.
void refuse_if_strict(const Options& options, const Catheter& catheter, const TrackerFrame& frame, const Estimate& estimate) {
  if (!options.strict) return;
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("{}: frame {} at {} s: {} (--strict)", options.recording, frame.number, frame.time_s, what));
  };
  if (estimate.time == FrameTime::kStandsStill) refuse("time stands still: expected a later time than the frame before");
  if (estimate.time == FrameTime::kStepsBack || estimate.time == FrameTime::kResynchronised)
    refuse("time steps back: expected a later time than the frame before");
  if (estimate.time == FrameTime::kNotFinite) refuse("time is not finite: expected seconds");
  for (std::size_t i = 0; i < frame.readings.size(); ++i) {
    const Rejection reason = estimate.rejections[i];
    if (reason == Rejection::kNone || reason == Rejection::kMissing) continue;
    const std::string& name = i < catheter.sensors.size() ? catheter.sensors[i].name : catheter.base.sensor.name;
    refuse(fmt::format("sensor \"{}\": {}", name, describe(reason)));
  }
  if (estimate.used == 0) refuse(fmt::format("status {}: expected at least one usable sensor", describe(estimate.status)));
}

int run(const Options& options) {
  CatheterFile file = read_catheter_file(options.catheter);
  apply_flags(options, file.observer);
  parse_reference(options.reference, file.reference);
  for (const std::string& warning : file.warnings) warn(warning);

  TrackerRecording recording = load_recording(options, file);
  if (options.strict && recording.duplicate_rows > 0)
    throw InputError(fmt::format("{}: {} duplicate rows: expected one row a sensor a frame (--strict)", options.recording, recording.duplicate_rows));
  check_reach(file.catheter, recording);
  attach_tendon(options.tendon, file.catheter, recording);

  EstimateReport report(recording);
  Catheter catheter = file.catheter;
  if (file.reference.given) {
    const Tare found = tare(catheter, recording.frames, {file.reference.from_s, file.reference.to_s, file.reference.straight});
    catheter = found.catheter;
    report.set_tare(found);
  }
  ForceObserver observer(catheter, file.observer);
  EstimateCsvWriter writer(options.out);
  for (const TrackerFrame& frame : recording.frames) {
    const Estimate estimate = observer.update(frame);
    refuse_if_strict(options, catheter, frame, estimate);
    writer.write(estimate);
    report.add(estimate, frame.readings.size());
  }
  if (!options.plot.empty()) report.plot(options.plot, catheter.name);
  writer.commit();
  report.print(catheter, file.observer, options.out, options.json);
  return 0;
}

}  // namespace

void add_estimate(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("estimate", "Tip force over time, with its sigma, from a recording of tracker poses");
  verb->add_option("recording", options->recording,
                   "tracker CSV, PLUS .igs.mha, NDI CSV, marker CSV, or MR coil text (a file or its folder)")->required();
  verb->add_option("--catheter", options->catheter, "catheter file (TOML)")->required();
  verb->add_option("--out", options->out, "estimate CSV to write")->required();
  verb->add_option("--tendon", options->tendon, "tendon CSV: moment or tension over time");
  verb->add_option("--method", options->method, "ekf, iekf or iaekf, instead of the catheter file's");
  verb->add_option("--measurement", options->measurement, "poses or tip_and_curvature, instead of the catheter file's");
  verb->add_option("--state", options->state, "what is estimated: force");
  verb->add_option("--reference", options->reference, "FROM:TO in seconds without tip force: corrects base and precurvature");
  verb->add_option("--plot", options->plot, "draw force and 95 % band over time (.svg or .png)");
  verb->add_flag("--smooth", options->smooth, "use later frames as well (not in this version)");
  verb->add_flag("--strict", options->strict, "make every reading that would be passed over an error");
  verb->add_flag("--json", options->json, "print the summary as JSON");
  verb->footer("Example: palpate estimate --catheter catheter.toml run.tracker.csv --out run.estimate.csv --plot run.svg");
  verb->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace palpate::app
