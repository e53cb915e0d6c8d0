// SPDX-License-Identifier: Apache-2.0
#include "report_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <palpate/evaluation/uncertainty_words.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/session/session_run_reader.hpp>

#include "estimate_input.hpp"
#include "reference_tare.hpp"

namespace palpate::app {

namespace {

/// The options of `palpate estimate` that say how a recording is to be read.
EstimateOptions reading_options(const ReportOptions& options) {
  EstimateOptions reading;
  reading.recordings = options.recordings;
  reading.catheter = options.catheter;
  reading.tendon = options.tendon;
  reading.reference = options.reference;
  return reading;
}

/// Counts the readings frame by frame: by the observer's verdict where it ran, else by the screening alone.
class SensorCounter {
 public:
  SensorCounter(const Catheter& catheter, const std::vector<std::string>& names) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      shares_.push_back({.name = names[i]});
      kinds_.push_back(i < catheter.sensors.size() ? catheter.sensors[i].kind : SensorKind::kPose);
    }
  }
  void add(const TrackerFrame& frame, const Estimate* estimate) {
    for (std::size_t i = 0; i < shares_.size(); ++i) {
      const Rejection reason = estimate ? estimate->rejections[i] : screen(frame.readings[i], kinds_[i]);
      if (reason != Rejection::kAbsent) ++shares_[i].frames;
      ++shares_[i].by_reason[static_cast<std::size_t>(reason)];
    }
  }
  std::vector<SensorShare> finish() { return std::move(shares_); }

 private:
  std::vector<SensorShare> shares_;
  std::vector<SensorKind> kinds_;
};

void read_frames(RunReader& reader, ReportRun& run) {
  const ObserverOptions& options = run.description.settings.observer;
  std::optional<ForceObserver> observer;
  if (!run.description.has_estimates) observer.emplace(run.catheter, options);
  SensorCounter sensors(run.catheter, run.description.sensor_names);
  RunSummaryBuilder summary;
  RunMoment moment;
  while (reader.next(moment)) {
    if (observer) {
      const Estimate estimate = observer->update(moment.frame);
      summary.add(estimate, moment.frame.readings.size());
      sensors.add(moment.frame, &estimate);
      moment.estimate = row_of(estimate);
    } else {
      sensors.add(moment.frame, nullptr);
    }
    run.rows.push_back(*moment.estimate);
    run.frames.push_back(moment.frame);
  }
  run.sensors = sensors.finish();
  if (observer) run.uncertainty_words = in_words(summary.finish().uncertainty, options);
}

/// A truth of another time would be drawn beside nothing.
void refuse_truth_elsewhere(const ReportRun& run) {
  if (!run.truth) return;
  const bool meets = std::any_of(run.rows.begin(), run.rows.end(),
                                 [&](const EstimateRow& row) { return run.truth->interpolate(row.time_s).inside; });
  if (!meets)
    throw InputError(
        fmt::format("{}: no sample in the recording's time: expected the force of this recording", run.truth->source));
}

void warn_of_few_measured(const std::string& recording, ReportRun& run) {
  const auto measured = static_cast<std::size_t>(
      std::count_if(run.sizes.begin(), run.sizes.end(), [](const ForceSize& size) { return size.measured; }));
  if (2 * measured < run.sizes.size())
    run.warnings.push_back(
        fmt::format("{}: only {} of {} frames could be used: is it of this catheter, base and sensors?", recording,
                    measured, run.sizes.size()));
}

/// Seconds since 1970 have no room for milliseconds on a page.
void count_time_from_start(ReportRun& run) {
  constexpr double kLongest_s = 1e6;
  const auto first =
      std::find_if(run.rows.begin(), run.rows.end(), [](const EstimateRow& row) { return std::isfinite(row.time_s); });
  if (first == run.rows.end() || first->time_s < kLongest_s) return;
  const double start_s = first->time_s;
  for (EstimateRow& row : run.rows) row.time_s -= start_s;
  for (TrackerFrame& frame : run.frames) frame.time_s -= start_s;
  for (RunEvent& event : run.events)
    if (event.time_s) *event.time_s -= start_s;
  for (RunGap& gap : run.gaps) gap = {gap.from_s - start_s, gap.to_s - start_s};
  if (run.truth)
    for (double& time_s : run.truth->times_s) time_s -= start_s;
}

/// Reads all of it, and what is said beside it.
void read_run(RunReader& reader, const std::string& source, const ReportOptions& options, ReportRun& run) {
  run.description = reader.description();
  if (!options.truth.empty()) run.truth = read_force_csv(options.truth);
  read_frames(reader, run);
  run.events = reader.events();
  run.gaps = reader.gaps();
  count_time_from_start(run);
  run.sizes = force_sizes(run.rows);
  refuse_truth_elsewhere(run);
  warn_of_few_measured(source, run);
}

bool is_session(const ReportOptions& options) {
  return options.recordings.size() == 1 && session::looks_like_session(options.recordings.front());
}

/// A session brings catheter, tendon, reference and estimates along.
ReportRun read_session_report(const ReportOptions& options) {
  const std::string& path = options.recordings.front();
  using Given = std::pair<const char*, const std::string*>;
  for (const auto& [flag, value] : {Given{"--catheter", &options.catheter}, Given{"--estimate", &options.estimate},
                                    Given{"--tendon", &options.tendon}, Given{"--reference", &options.reference}})
    if (!value->empty())
      throw InputError(fmt::format("{} {}: expected none: {} is a session, which has its own", flag, *value, path));
  session::SessionRunReader reader(path, options.name);
  ReportRun run;
  run.warnings = reader.description().settings.warnings;
  run.catheter = reader.description().settings.catheter;
  read_run(reader, path, options, run);
  if (run.rows.empty()) throw InputError(fmt::format("{}: expected at least one frame", path));
  return run;
}

ReportRun read_file_report(const ReportOptions& options) {
  if (options.catheter.empty()) throw InputError("--catheter: expected the catheter file of the recording");
  if (!options.name.empty()) throw InputError("--name: expected a session, which may hold several catheters");
  const EstimateOptions reading = reading_options(options);
  const TextFile text = read_text_file(options.catheter);
  CatheterFile file = parse_catheter(text);
  apply_options(reading, file);
  if (!options.tendon.empty()) file.catheter = driven_by_map(file.catheter);
  ReportRun run;
  run.warnings = file.warnings;
  TrackerRecording recording = load_recording(reading, file, run.warnings);
  run.catheter = correct_by_reference(file, recording, run.warnings).catheter;
  RunDescription description;
  description.catheter_source = options.catheter;
  description.catheter_text = fmt::format("{}\n", fmt::join(text.lines, "\n"));
  description.settings = std::move(file);
  const std::string source = recording.source;
  FileRunReader reader(std::move(recording), std::move(description), options.estimate);
  read_run(reader, source, options, run);
  return run;
}

}  // namespace

ReportRun read_report_run(const ReportOptions& options) {
  return is_session(options) ? read_session_report(options) : read_file_report(options);
}

}  // namespace palpate::app
