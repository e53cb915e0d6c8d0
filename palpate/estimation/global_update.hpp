// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <palpate/estimation/consistency.hpp>
#include <palpate/estimation/kalman.hpp>

namespace palpate {

/// A measurement model that can guess the state from the measurement alone, in several ways, the best guess first.
template <class M>
concept SeededModel = MeasurementModel<M> && requires(M& model, int k, StateVector& x, int& evaluations) {
  { model.seed(k, x, evaluations) } -> std::same_as<bool>;  ///< false: no k-th guess; adds the work it took
};

struct SearchOptions {
  UpdateOptions local = {};
  int max_evaluations = 200;  ///< of the model, seeds included; range [20, 10000]
};

/// The right minimum of the MAP cost from any start, with bounded work. A wrong local minimum gives itself away by its
/// cost: at the right one the post-fit residual is chi-square with rows - states degrees of freedom (nuisance states,
/// which bring their own prior, not counted).
///
///   1. damped iterated update from `start`; a plausible end is the answer
///   2. otherwise from one seed after the other, until one ends plausibly; the least cost is kept
///
/// A cost that is merely unlikely (1 in a million) is believed once a second search has ended in the same place. Where
/// the data hardly over-determine the state (surplus below three), every seed is tried, for several states may explain
/// them: where the two minima of least cost do equally well, the one nearer to the prior is kept, and the status says
/// kAmbiguous.
class GlobalUpdate {
 public:
  explicit GlobalUpdate(const SearchOptions& options = {}) : options_(options) {}

  /// `start`: nullptr for seeds alone, without any memory. No seed is begun after SearchOptions::max_evaluations, but
  /// one that was, and the search from it, are brought to their end: fewer than seed + 1 + local.max_iterations more.
  /// No allocation.
  template <SeededModel Model>
  void run(Model& model, const Gaussian& prior, const StateVector* start, Update& out) {
    detail::begin(model.rows(), prior, best_);
    spent_ = 0;
    confirmed_ = has_rival_ = false;
    if (start != nullptr) attempt(model, prior, *start, UpdateStatus::kConverged);
    StateVector x = prior.mean;
    for (int k = 0; !settled() && spent_ < options_.max_evaluations && model.seed(k, x, spent_); ++k)
      attempt(model, prior, x, UpdateStatus::kReseeded);
    if (has_rival_ && equally_good()) choose_nearer(prior);
    out = best_;
    out.evaluations = spent_;
  }

 private:
  static constexpr double kUnlikely = 1e-6, kImpossible = 1e-12;
  static constexpr double kSameMinimum = 1.0, kOtherMinimum = 4.0;  ///< distance in posterior sigmas
  static constexpr double kEquallyGood = 4.0;                       ///< difference of chi-square: two sigma
  static constexpr int kLeastSurplus = 3;

  int surplus() const {
    return best_.rows - static_cast<int>(best_.posterior.mean.size()) + options_.local.nuisance_states;
  }

  bool settled() const {
    if (!converged(best_.status) || surplus() < kLeastSurplus) return false;
    if (unlikely_.passes(best_.residual_chi_square, surplus())) return true;
    return confirmed_ && impossible_.passes(best_.residual_chi_square, surplus());
  }

  template <class Model>
  void attempt(Model& model, const Gaussian& prior, const StateVector& start, UpdateStatus if_best) {
    iterated_update(model, prior, start, options_.local, trial_);
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

  bool better() const {
    if (converged(trial_.status) != converged(best_.status)) return converged(trial_.status);
    return trial_.chi_square < best_.chi_square;
  }

  /// In posterior sigmas of the best.
  double distance_to_best(const Update& candidate) const {
    const StateVector d = candidate.posterior.mean - best_.posterior.mean;
    return std::sqrt(normalised_error_squared(d, best_.posterior.covariance));
  }

  void remember_rival(const Update& candidate) {
    if (!converged(candidate.status)) return;
    if (has_rival_ && candidate.chi_square >= rival_.chi_square) return;
    rival_ = candidate;
    has_rival_ = true;
  }

  bool equally_good() const {
    return converged(best_.status) && distance_to_best(rival_) > kOtherMinimum &&
           std::abs(rival_.residual_chi_square - best_.residual_chi_square) < kEquallyGood;
  }

  void choose_nearer(const Gaussian& prior) {
    const auto from_prior = [&](const Update& update) {
      return normalised_error_squared(update.posterior.mean - prior.mean, prior.covariance);
    };
    if (from_prior(rival_) < from_prior(best_)) best_ = rival_;
    best_.status = UpdateStatus::kAmbiguous;
  }

  SearchOptions options_;
  ChiSquareGate unlikely_{kUnlikely}, impossible_{kImpossible};
  Update best_, rival_, trial_;
  UpdateStatus origin_ = UpdateStatus::kConverged;  ///< of the best, once it has converged
  int spent_ = 0;
  bool confirmed_ = false, has_rival_ = false;
};

}  // namespace palpate
