// SPDX-License-Identifier: Apache-2.0
#include "report_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <palpate/evaluation/uncertainty_words.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/recording/text_table.hpp>

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

}  // namespace

ReportRun read_report_run(const ReportOptions& options) {
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
  run.description = reader.description();
  if (!options.truth.empty()) run.truth = read_force_csv(options.truth);
  read_frames(reader, run);
  run.events = reader.events();
  run.gaps = reader.gaps();
  run.sizes = force_sizes(run.rows);
  refuse_truth_elsewhere(run);
  warn_of_few_measured(source, run);
  return run;
}

}  // namespace palpate::app
