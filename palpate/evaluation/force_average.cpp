// SPDX-License-Identifier: Apache-2.0
#include <palpate/evaluation/force_average.hpp>

namespace palpate {

void ForceAverage::add(const Estimate& estimate) {
  if (estimate.used == 0 || !(estimate.time_s >= from_s_ && estimate.time_s <= to_s_)) return;
  ++frames_;
  force_tip_N_ += estimate.force_tip_N;
  force_base_N_ += estimate.force_base_N;
  covariance_base_N2_ += estimate.R_base_tip * estimate.covariance_tip_N2 * estimate.R_base_tip.transpose();
}

}  // namespace palpate
