// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <palpate/service/consistency_alarm.hpp>

namespace palpate::service {

namespace {

constexpr double kQuantile = 4.753424;  // of the standard normal at 1 - 1e-6

double chi_square_bound(int dof) {
  const double spread = 2.0 / (9.0 * dof);
  return dof * std::pow(1.0 - spread + kQuantile * std::sqrt(spread), 3);
}

bool is_refused(const Estimate& estimate) {
  return estimate.status == EstimateStatus::kRejected || estimate.status == EstimateStatus::kNotConverged ||
         std::find(estimate.rejections.begin(), estimate.rejections.end(), Rejection::kOutlier) !=
             estimate.rejections.end();
}

}  // namespace

void ConsistencyAlarm::take(const Estimate& estimate) {
  if (!moves_the_clock(estimate.time)) return;  // a bad clock says nothing of the shape
  frames_[count_++ % kWindow] = {estimate.nis, estimate.dof, is_refused(estimate)};
  double nis = 0.0;
  int dof = 0;
  std::size_t refused = 0;
  for (const Frame& frame : frames_) {
    nis += frame.nis;
    dof += frame.dof;
    refused += frame.refused ? 1 : 0;
  }
  alarmed_ = refused > kWindow / 3 || (dof > 0 && nis > chi_square_bound(dof));
}

}  // namespace palpate::service
