// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <palpate/evaluation/run_summary.hpp>

namespace palpate {

namespace {

double median(std::vector<float>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void RunSummaryBuilder::add(const Estimate& estimate, std::size_t readings) {
  RunSummary& s = summary_;
  if (s.frames++ == 0) s.first_time_s = estimate.time_s;
  s.last_time_s = estimate.time_s;
  ++s.by_status[static_cast<std::size_t>(estimate.status)];
  s.time_stood_still += estimate.time == FrameTime::kStandsStill;
  s.time_stepped_back += estimate.time == FrameTime::kStepsBack;
  s.time_not_finite += estimate.time == FrameTime::kNotFinite;
  s.clock_resynchronised += estimate.time == FrameTime::kResynchronised;
  if (estimate.time <= FrameTime::kResynchronised)
    for (std::size_t i = 0; i < readings; ++i) ++s.readings_by_reason[static_cast<std::size_t>(estimate.rejections[i])];

  uncertainty_.add(estimate);
  s.last_force_tip_N = estimate.force_tip_N;
  s.last_force_base_N = estimate.force_base_N;
  s.last_sigma_N = estimate.covariance_tip_N2.diagonal().cwiseSqrt();
  if (estimate.used == 0) return;
  ++updated_;
  s.mean_force_tip_N += estimate.force_tip_N;
  s.largest_force_N = std::max(s.largest_force_N, estimate.force_tip_N.norm());
  s.mean_nis_per_dof += estimate.nis / estimate.dof;
  s.mean_rho_paper += estimate.convergence.paper;
  s.mean_rho_normalised += estimate.convergence.normalised;
  s.most_evaluations = std::max(s.most_evaluations, estimate.evaluations);
  evaluations_.push_back(static_cast<float>(estimate.evaluations));
  for (int axis = 0; axis < 3; ++axis) sigmas_[axis].push_back(static_cast<float>(s.last_sigma_N(axis)));
}

RunSummary RunSummaryBuilder::finish() {
  RunSummary s = summary_;
  if (updated_ > 0) {
    const auto n = static_cast<double>(updated_);
    s.mean_force_tip_N /= n;
    s.mean_nis_per_dof /= n;
    s.mean_rho_paper /= n;
    s.mean_rho_normalised /= n;
  }
  s.median_evaluations = median(evaluations_);
  for (int axis = 0; axis < 3; ++axis) s.median_sigma_N(axis) = median(sigmas_[axis]);
  s.uncertainty = uncertainty_.finish();
  return s;
}

}  // namespace palpate
