// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <palpate/estimation/global_update.hpp>

namespace palpate {

int GlobalUpdate::surplus() const {
  return best_.rows - static_cast<int>(best_.posterior.mean.size()) + options_.local.nuisance_states;
}

bool GlobalUpdate::settled() const {
  if (!converged(best_.status) || surplus() < kLeastSurplus) return false;
  if (unlikely_.passes(best_.residual_chi_square, surplus())) return true;
  return confirmed_ && impossible_.passes(best_.residual_chi_square, surplus());
}

void GlobalUpdate::judge_trial(UpdateStatus if_best) {
  spent_ += trial_.evaluations;
  if (!std::isfinite(trial_.chi_square) || trial_.status == UpdateStatus::kFailed) return;
  const bool first = best_.status == UpdateStatus::kFailed;
  const double distance = first ? 0.0 : distance_to_best(trial_);
  const bool same = !first && distance < kSameMinimum;
  confirmed_ = same || (confirmed_ && !better());
  if (!first && !better()) {
    if (distance > kOtherMinimum) remember_rival(trial_);
    return;
  }
  if (distance > kOtherMinimum) remember_rival(best_);
  if (!same) origin_ = if_best;  // who only finishes an earlier search has not led elsewhere
  best_ = trial_;
  if (converged(best_.status)) best_.status = origin_;
}

bool GlobalUpdate::better() const {
  if (converged(trial_.status) != converged(best_.status)) return converged(trial_.status);
  return trial_.chi_square < best_.chi_square;
}

/// In posterior sigmas of the best.
double GlobalUpdate::distance_to_best(const Update& candidate) const {
  const StateVector d = candidate.posterior.mean - best_.posterior.mean;
  return std::sqrt(normalised_error_squared(d, best_.posterior.covariance));
}

void GlobalUpdate::remember_rival(const Update& candidate) {
  if (!converged(candidate.status)) return;
  if (has_rival_ && candidate.chi_square >= rival_.chi_square) return;
  rival_ = candidate;
  has_rival_ = true;
}

bool GlobalUpdate::equally_good() const {
  return converged(best_.status) && distance_to_best(rival_) > kOtherMinimum &&
         std::abs(rival_.residual_chi_square - best_.residual_chi_square) < kEquallyGood;
}

void GlobalUpdate::choose_nearer(const Gaussian& prior) {
  const auto from_prior = [&](const Update& update) {
    return normalised_error_squared(update.posterior.mean - prior.mean, prior.covariance);
  };
  if (from_prior(rival_) < from_prior(best_)) best_ = rival_;
  best_.status = UpdateStatus::kAmbiguous;
}

}  // namespace palpate
