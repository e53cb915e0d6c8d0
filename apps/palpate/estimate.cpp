// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <optional>
#include <palpate/observer/smoothing.hpp>
#include <palpate/recording/budget_csv.hpp>
#include <palpate/recording/estimate_csv.hpp>

#include "estimate_input.hpp"
#include "estimate_options.hpp"
#include "estimate_report.hpp"
#include "estimate_warnings.hpp"
#include "file_paths.hpp"
#include "reference_tare.hpp"
#include "time_span.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

/// What a run writes frame by frame.
class OutputFiles {
 public:
  OutputFiles(const EstimateOptions& options, const ObserverOptions& observer)
      : estimate_(options.out, EstimateColumns::of(observer)) {
    if (!options.budget.empty()) budget_.emplace(options.budget);
  }
  void write(const Estimate& estimate) {
    estimate_.write(estimate);
    if (budget_) budget_->write(estimate);
  }
  void commit() {
    estimate_.commit();
    if (budget_) budget_->commit();
  }

 private:
  EstimateCsvWriter estimate_;
  std::optional<BudgetCsvWriter> budget_;
};

void estimate_all(const EstimateOptions& options, const TrackerRecording& recording, ForceObserver& observer,
                  OutputFiles& files, EstimateReport& report) {
  const auto put = [&](const Estimate& estimate, const TrackerFrame& frame) {
    files.write(estimate);
    report.add(estimate, frame.readings.size());
  };
  SmoothingPass smoothing(observer);
  for (const TrackerFrame& frame : recording.frames) {
    const Estimate estimate = observer.update(frame);
    if (options.strict) refuse_passed_over_readings(recording, frame, estimate);
    if (options.smooth)
      smoothing.add(observer, frame, estimate);
    else
      put(estimate, frame);
  }
  const std::vector<Estimate> smoothed = smoothing.finish(observer);
  for (std::size_t i = 0; i < smoothed.size(); ++i) put(smoothed[i], recording.frames[i]);
}

int run(const EstimateOptions& options) {
  check_paths(options);
  CatheterFile file = read_catheter_file(options.catheter);
  apply_options(options, file);
  if (!options.tendon.empty()) file.catheter = driven_by_map(file.catheter);
  warn_of_states_without_sigma(file, file.warnings);
  const TrackerRecording recording = load_recording(options, file, file.warnings);
  if (options.strict) refuse_passed_over_rows(recording);

  EstimateReport report(recording, options.smooth);
  if (!options.average.empty()) {
    const TimeSpan span = parse_time_span("--average", options.average);
    report.set_average(span.from_s, span.to_s);
  }
  const CorrectedCatheter corrected = correct_by_reference(file, recording, file.warnings);
  if (corrected.tare) report.set_tare(*corrected.tare);
  const Catheter& catheter = corrected.catheter;
  ForceObserver observer(catheter, file.observer);
  OutputFiles files(options, file.observer);
  estimate_all(options, recording, observer, files, report);
  if (!options.plot.empty()) report.plot(options.plot, catheter.name);
  files.commit();
  warn_of_few_used(recording, report.frames_used(), file.warnings);
  print_warnings(file.warnings);
  report.print(catheter, file.observer, options.out, options.json);
  return 0;
}

}  // namespace

void add_estimate(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<EstimateOptions>();
  CLI::App* verb =
      app.add_subcommand("estimate", "Tip force over time, with its sigma, from a recording of tracker poses");
  add_estimate_options(*verb, *options);
  verb->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace palpate::app
