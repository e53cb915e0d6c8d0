// SPDX-License-Identifier: Apache-2.0
#include <palpate/observer/smoothing.hpp>

namespace palpate {

void SmoothingPass::add(const ForceObserver& observer, const TrackerFrame& frame, const Estimate& estimate) {
  estimates_.push_back(estimate);
  // As in the observer, what a frame does not tell is as it was; before any is told, as the catheter file says.
  const TendonReading no_moment{.present = true};
  const BendReading no_change{.present = true};
  const bool bent = frame.bend.present && frame.bend.change_per_m.allFinite();
  tendons_.push_back(frame.tendon.present ? frame.tendon : tendons_.empty() ? no_moment : tendons_.back());
  bends_.push_back(bent ? frame.bend : bends_.empty() ? no_change : bends_.back());
  if (moves_the_clock(estimate.time)) smoother_.push(observer.motion().step(), observer.motion().belief());
}

std::vector<Estimate> SmoothingPass::finish(ForceObserver& observer) {
  const std::vector<SmoothedFrame> smoothed = smoother_.smooth();
  std::size_t next = 0;
  for (std::size_t i = 0; i < estimates_.size(); ++i) {
    Estimate& e = estimates_[i];
    if (!moves_the_clock(e.time)) continue;
    const SmoothedFrame& frame = smoothed[next++];
    const ForceGaussian& force = frame.force;
    e.force_tip_N = force.mean_N;
    e.covariance_tip_N2 = force.covariance_N2;
    e.sigma_by_source_N = observer.uncertainty().budget(frame);
    e.shaft = observer.uncertainty().shaft(frame);
    e.shaft.precurvature_per_m.head<2>() += bends_[i].change_per_m;
    e.R_base_tip = observer.R_base_tip(force.mean_N, tendons_[i], bends_[i]);
    e.force_base_N = e.R_base_tip * e.force_tip_N;
  }
  return std::move(estimates_);
}

}  // namespace palpate
