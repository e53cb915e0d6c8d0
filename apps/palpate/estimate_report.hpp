// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <palpate/evaluation/force_average.hpp>
#include <palpate/evaluation/run_summary.hpp>
#include <palpate/identification/tare.hpp>
#include <palpate/observer/options.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <string>
#include <vector>

namespace palpate::app {

/// What `palpate estimate` tells a person, a program (JSON) and the eye (picture) about a run.
class EstimateReport {
 public:
  EstimateReport(const TrackerRecording& recording, bool smoothed) : recording_(recording), smoothed_(smoothed) {}

  void set_tare(const Tare& tare) { tare_ = tare; }
  void set_average(double from_s, double to_s) { average_.emplace(from_s, to_s); }
  void add(const Estimate& estimate, std::size_t readings);
  std::size_t frames_used() const {
    return static_cast<std::size_t>(std::count(updated_.begin(), updated_.end(), true));
  }
  /// Force and its 95 % band over time, one panel an axis. Throws InputError where it cannot be drawn.
  void plot(const std::string& path, const std::string& title) const;
  void print(const Catheter& catheter, const ObserverOptions& options, const std::string& out, bool json);

 private:
  void print_counts(const RunSummary& summary) const;
  void print_tare() const;
  void print_figures(const RunSummary& summary) const;
  void print_average(const Catheter& catheter) const;
  void print_json(const RunSummary& summary, const Catheter& catheter, const ObserverOptions& options,
                  const std::string& out) const;

  const TrackerRecording& recording_;
  bool smoothed_;
  std::optional<Tare> tare_;
  std::optional<ForceAverage> average_;
  RunSummaryBuilder summary_;
  std::vector<double> times_s_;
  std::vector<Vector3d> force_N_, sigma_N_;
  std::vector<bool> updated_;  ///< false: the force is a prediction
};

}  // namespace palpate::app
