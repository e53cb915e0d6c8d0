// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/reproduction/experiment_runs.hpp>
#include <string>

/// Table 7's figures of an experiment, over its repeats.
namespace palpate::reproduction {

struct ExperimentSummary {
  std::vector<RepeatStatistics> errors;  ///< as kEstimators
  ForceBounds bounds;                    ///< root mean square over the repeats
  Vector3d inside_95_online = Vector3d::Zero(), inside_95_smoothed = Vector3d::Zero();  ///< of our IEKF
  std::size_t frames = 0;                                                               ///< judged, of a repeat

  const RepeatStatistics& error(Estimator e) const { return errors[static_cast<std::size_t>(e)]; }
};

/// Precondition: at least two runs, of one experiment.
ExperimentSummary summarise(std::span<const ExperimentRun> runs);

/// Our axial error against that of IAEKF in Table 7.
struct AxialVerdict {
  double paper_mean_N = 0.0, paper_sigma_N = 0.0;
  double mean_N = 0.0, sigma_N = 0.0;
  double bound_N = 0.0;  ///< of sigma

  bool mean_met() const { return mean_N <= paper_mean_N; }
  bool sigma_met() const { return sigma_N <= paper_sigma_N; }
  bool sigma_in_reach() const { return bound_N < paper_sigma_N; }
};
/// Smoothed: against the bound with all frames; otherwise with those before.
AxialVerdict axial_verdict(ExperimentId id, const ExperimentSummary& summary, Estimator estimator);

/// What to call it: "both met", "mean met; sigma below the bound", ...
std::string describe(const AxialVerdict& verdict);

}  // namespace palpate::reproduction
