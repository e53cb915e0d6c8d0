// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/evaluation/contacts.hpp>
#include <palpate/evaluation/run_summary.hpp>
#include <palpate/recording/force_csv.hpp>
#include <palpate/recording/run_reader.hpp>

namespace palpate::app {

/// The command line of `palpate report`, as typed; empty: not given.
struct ReportOptions {
  std::vector<std::string> recordings;
  std::string catheter, estimate, truth, tendon, reference, name, title, out, bands = "5,10,30,40";
  double contact_g = 5.0;
  bool json = false;
};

/// How often one sensor could be used.
struct SensorShare {
  std::string name;
  std::size_t frames = 0;                            ///< that speak of it
  std::array<std::size_t, kRejections> by_reason{};  ///< of its readings; kNone: usable
};

/// A whole run in memory, with what was made of it, ready to be told.
struct ReportRun {
  RunDescription description;
  Catheter catheter;  ///< as the reference interval corrects it
  std::vector<TrackerFrame> frames;
  std::vector<EstimateRow> rows;  ///< one a frame
  std::vector<ForceSize> sizes;   ///< one a frame
  std::optional<ForceTrace> truth;
  std::vector<RunEvent> events;
  std::vector<RunGap> gaps;
  std::vector<SensorShare> sensors;
  std::string uncertainty_words;  ///< empty where the estimate was read from a file
  std::vector<std::string> warnings;
};

/// Reads recording and estimate, or runs the observer where no estimate is given. Throws InputError.
ReportRun read_report_run(const ReportOptions& options);

}  // namespace palpate::app
