// SPDX-License-Identifier: Apache-2.0
#pragma once

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

  int surplus() const;
  bool settled() const;

  template <class Model>
  void attempt(Model& model, const Gaussian& prior, const StateVector& start, UpdateStatus if_best) {
    iterated_update(model, prior, start, options_.local, trial_);
    judge_trial(if_best);
  }

  void judge_trial(UpdateStatus if_best);
  bool better() const;
  double distance_to_best(const Update& candidate) const;
  void remember_rival(const Update& candidate);
  bool equally_good() const;
  void choose_nearer(const Gaussian& prior);

  SearchOptions options_;
  ChiSquareGate unlikely_{kUnlikely}, impossible_{kImpossible};
  Update best_, rival_, trial_;
  UpdateStatus origin_ = UpdateStatus::kConverged;  ///< of the best, once it has converged
  int spent_ = 0;
  bool confirmed_ = false, has_rival_ = false;
};

}  // namespace palpate
