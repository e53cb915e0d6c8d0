// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <optional>
#include <palpate/identification/tare.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/observer/smoothing.hpp>
#include <palpate/recording/estimate_csv.hpp>
#include <palpate/recording/force_csv.hpp>

#include "estimate_input.hpp"
#include "file_paths.hpp"
#include "identify_delay_report.hpp"
#include "identify_files.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

struct Options {
  std::vector<std::string> recordings;
  std::string catheter, estimate, truth, tendon;
  std::string out, plot;
  double max_delay_s = DelayOptions().max_delay_s;
  bool fixed_gain = false, json = false;
};

void check(const Options& options) {
  std::vector<InputPath> inputs{{"--truth", "the force CSV", options.truth}};
  for (const std::string& recording : options.recordings) inputs.push_back({"recording", "the recording", recording});
  for (const InputPath& input : {InputPath{"--catheter", "the catheter file", options.catheter},
                                 {"--estimate", "the estimate", options.estimate},
                                 {"--tendon", "the tendon CSV", options.tendon}})
    if (!input.path.empty()) inputs.push_back(input);
  check_paths(inputs, {{"--out", options.out}, {"--plot", options.plot}});
  if (options.recordings.empty() == options.estimate.empty())
    throw InputError("expected either a recording, with --catheter, or --estimate");
  if (!options.recordings.empty() && options.catheter.empty())
    throw InputError("--catheter: expected the catheter file, for the force is felt from a recording");
  if (!(options.max_delay_s > 0.0 && options.max_delay_s <= 1000.0))
    throw InputError(fmt::format("--max-delay {}: expected seconds, more than 0, at most 1000", options.max_delay_s));
}

bool tells_force(EstimateStatus status) {
  return status == EstimateStatus::kUpdated || status == EstimateStatus::kReseeded ||
         status == EstimateStatus::kAmbiguous;
}

/// Only frames that say something, in time order, with a sigma to weigh them by.
void add_force(double time_s, EstimateStatus status, const Vector3d& force_N, const Matrix3d& covariance_N2,
               std::vector<TimedForce>& felt) {
  const Vector3d sigma_N = covariance_N2.diagonal().cwiseSqrt();
  if (!tells_force(status) || !std::isfinite(time_s) || !force_N.allFinite()) return;
  if (!sigma_N.allFinite() || !(sigma_N.minCoeff() > 0.0)) return;
  if (!felt.empty() && !(time_s > felt.back().time_s)) return;
  felt.push_back({time_s, force_N, sigma_N});
}

std::vector<TimedForce> read_estimate(const std::string& path) {
  std::vector<TimedForce> felt;
  for (const EstimateRow& row : read_estimate_csv(path))
    add_force(row.time_s, row.status, row.force_tip_N, row.covariance_tip_N2, felt);
  if (felt.empty()) throw InputError(fmt::format("{}: expected rows with status UPDATED", path));
  return felt;
}

/// The force of the whole recording as `palpate estimate --smooth` gives it: a filter that only looks back lags.
std::vector<TimedForce> feel(const Options& options, CatheterFile& file) {
  EstimateOptions as_estimate;
  as_estimate.recordings = options.recordings;
  as_estimate.tendon = options.tendon;
  const TrackerRecording recording = load_recording(as_estimate, file, file.warnings);
  const ReferenceInterval& reference = file.reference;
  const Catheter catheter =
      reference.given
          ? tare(file.catheter, recording.frames, {reference.from_s, reference.to_s, reference.straight}).catheter
          : file.catheter;
  ForceObserver observer(catheter, file.observer);
  SmoothingPass smoothing(observer);
  for (const TrackerFrame& frame : recording.frames) smoothing.add(observer, frame, observer.update(frame));
  std::vector<TimedForce> felt;
  for (const Estimate& estimate : smoothing.finish(observer))
    add_force(estimate.time_s, estimate.status, estimate.force_tip_N, estimate.covariance_tip_N2, felt);
  if (felt.empty())
    throw InputError(fmt::format("{}: no frame of {} tells a force: expected usable sensors", recording.source,
                                 recording.frames.size()));
  return felt;
}

std::vector<TimedForce> read_truth(const std::string& path) {
  const ForceTrace trace = read_force_csv(path);
  std::vector<TimedForce> sensor;
  for (std::size_t i = 0; i < trace.times_s.size(); ++i) sensor.push_back({trace.times_s[i], trace.force_tip_N[i]});
  return sensor;
}

/// All sensors of one recording share its times: each gets what was found on top of what it has.
TomlEdit edited(const Options& options, const Catheter& catheter, const DelayFit& fit) {
  TomlEdit edit(options.catheter);
  for (const Sensor* sensor : all_sensors(catheter)) {
    const SensorPlace place = place_of(edit, *sensor);
    edit.set(place.table, place.index, "delay_s", toml_number(sensor->delay_s + fit.delay_s, 9),
             fmt::format("identified: +- {:.1g} s, {} samples", fit.sigma_s, fit.used));
  }
  parse_catheter({.name = options.out, .lines = edit.lines()});
  return edit;
}

DelayFit compare(const Options& options, const DelayReport& report) {
  try {
    return identify_delay(report.felt, read_truth(options.truth),
                          {.max_delay_s = options.max_delay_s, .free_gain = !options.fixed_gain});
  } catch (const InputError& error) {
    const std::string what = error.what();
    if (what.starts_with(options.truth)) throw;
    throw InputError(fmt::format("{}: {}", options.truth, what));
  }
}

int run(const Options& options) {
  check(options);
  std::optional<CatheterFile> file;
  if (!options.catheter.empty()) file = read_catheter_file(options.catheter);
  DelayReport report{
      .tracker = fmt::format("{}", options.recordings.empty() ? options.estimate : options.recordings[0]),
      .sensor = options.truth,
      .smoothed = options.estimate.empty(),
      .earlier_s = file ? file->catheter.sensors[0].delay_s : 0.0,
      .felt = options.estimate.empty() ? feel(options, *file) : read_estimate(options.estimate),
      .fit = {},
      .out = options.out};
  report.fit = compare(options, report);
  std::vector<std::string> warnings = file ? file->warnings : std::vector<std::string>{};
  for (std::string& warning : warnings_of(report)) warnings.push_back(std::move(warning));
  std::optional<TomlEdit> edit;
  if (!report.out.empty()) edit = edited(options, file->catheter, report.fit);
  const auto plot = [&] {
    if (!options.plot.empty()) report.plot(options.plot);
  };
  edit ? write_catheter_file(*edit, report.out, plot) : plot();
  print_warnings(warnings);
  options.json ? report.print_json() : report.print();
  return 0;
}

}  // namespace

void add_identify_delay(CLI::App& identify, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = identify.add_subcommand(
      "delay", "Time offset between a tracker, by the force it feels, and a force sensor's trace");
  verb->add_option("recording", options->recordings, "of any format that palpate estimate reads, one or several")
      ->type_name("FILE");
  CLI::Option* catheter = verb->add_option("--catheter", options->catheter, "catheter file (TOML)")->type_name("FILE");
  verb->add_option("--estimate", options->estimate, "estimate CSV instead of a recording; its filter's lag counts")
      ->type_name("FILE");
  verb->add_option("--truth", options->truth, "force CSV of the force sensor")->type_name("FILE")->required();
  verb->add_option("--tendon", options->tendon, "tendon CSV of the recording")->type_name("FILE");
  verb->add_option("--out", options->out, "catheter file to write, the delay found added to its delay_s")
      ->type_name("FILE")
      ->needs(catheter);
  verb->add_option("--max-delay", options->max_delay_s, "the delay is sought within +- this")
      ->type_name("SECONDS")
      ->capture_default_str();
  verb->add_flag("--fixed-gain", options->fixed_gain, "both forces are of one scale");
  verb->add_option("--plot", options->plot, "draw both forces over each other (.svg or .png)")->type_name("FILE");
  verb->add_flag("--json", options->json, "print the figures as JSON");
  verb->footer(
      "Example: palpate identify delay --catheter catheter.toml run.tracker.csv --truth run.force.csv "
      "--out identified.toml\n"
      "         palpate identify delay --estimate run.estimate.csv --truth run.force.csv --max-delay 0.3");
  verb->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace palpate::app
