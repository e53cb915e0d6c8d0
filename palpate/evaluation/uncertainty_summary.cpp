// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <palpate/evaluation/uncertainty_summary.hpp>

namespace palpate {

void UncertaintySummaryBuilder::Median::add(double value) {
  if (value > 0.0)
    positive_.push_back(static_cast<float>(value));
  else
    ++zeros_;
}

double UncertaintySummaryBuilder::Median::finish() {
  const std::size_t middle = (zeros_ + positive_.size()) / 2;
  if (middle < zeros_ || positive_.empty()) return 0.0;
  const auto at = positive_.begin() + static_cast<std::ptrdiff_t>(middle - zeros_);
  std::nth_element(positive_.begin(), at, positive_.end());
  return *at;
}

void UncertaintySummaryBuilder::count_hidden(const Observability& o) {
  HiddenFrames& hidden = summary_.hidden;
  hidden.axial_force += o.axial_force_hidden;
  hidden.axial_force_straight += o.axial_force_hidden && o.shaft_straight;
  hidden.lateral_force += o.lateral_force_hidden;
  hidden.stiffness_scale += o.stiffness_rests_on_prior;
  hidden.precurvature += o.precurvature_rests_on_prior;
}

void UncertaintySummaryBuilder::add(const Estimate& estimate) {
  const Observability& o = estimate.observability;
  summary_.last_covariance_tip_N2 = estimate.covariance_tip_N2;
  summary_.last_shaft = estimate.shaft;
  summary_.last_observability = o;
  if (estimate.used == 0) return;
  ++summary_.frames_used;
  count_hidden(o);
  for (std::size_t source = 0; source < kUncertaintySources; ++source)
    for (std::size_t axis = 0; axis < 3; ++axis)
      sigmas_[source][axis].add(estimate.sigma_by_source_N[source](static_cast<Eigen::Index>(axis)));
  if (std::isnan(o.weakest_sigmas)) return;  // would spoil the order
  Weakest& weakest = weakest_.emplace_back();
  weakest.prior_sigmas = static_cast<float>(o.weakest_sigmas);
  Eigen::Map<Eigen::Matrix<float, 9, 1>>(weakest.direction.data()) << o.weakest_force_N.cast<float>(),
      o.weakest_log_stiffness.cast<float>(), o.weakest_precurvature_per_m.cast<float>();
}

WeakestDirection UncertaintySummaryBuilder::median_weakest() {
  if (weakest_.empty()) return {};
  const auto middle = weakest_.begin() + static_cast<std::ptrdiff_t>(weakest_.size() / 2);
  std::nth_element(weakest_.begin(), middle, weakest_.end(),
                   [](const Weakest& a, const Weakest& b) { return a.prior_sigmas < b.prior_sigmas; });
  const Eigen::Matrix<double, 9, 1> direction =
      Eigen::Map<const Eigen::Matrix<float, 9, 1>>(middle->direction.data()).cast<double>();
  return {direction.head<3>(), direction.segment<3>(3), direction.tail<3>(), middle->prior_sigmas};
}

UncertaintySummary UncertaintySummaryBuilder::finish() {
  UncertaintySummary summary = summary_;
  for (std::size_t source = 0; source < kUncertaintySources; ++source)
    for (std::size_t axis = 0; axis < 3; ++axis)
      summary.median_sigma_by_source_N[source](static_cast<Eigen::Index>(axis)) = sigmas_[source][axis].finish();
  summary.weakest = median_weakest();
  return summary;
}

}  // namespace palpate
