// SPDX-License-Identifier: Apache-2.0
#include <palpate/reproduction/experiment_summary.hpp>

namespace palpate::reproduction {
namespace {

ForceBounds rms_over(std::span<const ExperimentRun> runs) {
  const auto rms = [&](Vector3d ForceBounds::*bound) -> Vector3d {
    Vector3d sum = Vector3d::Zero();
    for (const ExperimentRun& run : runs) sum += (run.bounds.*bound).cwiseAbs2();
    return (sum / static_cast<double>(runs.size())).cwiseSqrt();
  };
  return {.frame_N = rms(&ForceBounds::frame_N),
          .online_N = rms(&ForceBounds::online_N),
          .smoothed_N = rms(&ForceBounds::smoothed_N),
          .mean_N = rms(&ForceBounds::mean_N)};
}

Vector3d coverage(std::span<const ExperimentRun> runs, Estimator e) {
  Vector3d sum = Vector3d::Zero();
  for (const ExperimentRun& run : runs)
    sum += inside_95(run.course(e).force_tip_N, run.truth_N, run.course(e).sigma_N, run.first);
  return sum / static_cast<double>(runs.size());
}

}  // namespace

ExperimentSummary summarise(std::span<const ExperimentRun> runs) {
  ExperimentSummary out;
  for (std::size_t e = 0; e < kEstimators.size(); ++e) {
    std::vector<ErrorStatistics> repeats;
    for (const ExperimentRun& run : runs) repeats.push_back(run.statistics[e]);
    out.errors.push_back(over_repeats(repeats));
  }
  out.bounds = rms_over(runs);
  out.frames = runs[0].times_s.size() - runs[0].first;
  out.inside_95_online = coverage(runs, Estimator::kIekf);
  out.inside_95_smoothed = coverage(runs, Estimator::kSmoothed);
  return out;
}

AxialVerdict axial_verdict(ExperimentId id, const ExperimentSummary& summary, Estimator estimator) {
  const PaperError& theirs = experiment(id).paper[2];
  const RepeatStatistics& ours = summary.error(estimator);
  const ForceBounds& bounds = summary.bounds;
  const bool smoothed = estimator == Estimator::kSmoothed || estimator == Estimator::kStatedSmoothed;
  return {.paper_mean_N = theirs.mean_N.z(),
          .paper_sigma_N = theirs.sigma_N.z(),
          .mean_N = ours.mean_N.z(),
          .sigma_N = ours.sigma_N.z(),
          .bound_N = smoothed ? bounds.smoothed_N.z() : bounds.online_N.z()};
}

std::string describe(const AxialVerdict& v) {
  if (v.mean_met() && v.sigma_met()) return "both met";
  const std::string sigma = v.sigma_met()        ? "sigma met"
                            : v.sigma_in_reach() ? "sigma missed"
                                                 : "their sigma is below the bound";
  return (v.mean_met() ? "mean met; " : "mean missed; ") + sigma;
}

}  // namespace palpate::reproduction
