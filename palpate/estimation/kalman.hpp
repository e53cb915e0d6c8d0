// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/estimation/whitened.hpp>

/// Measurement updates of the extended and the iterated extended Kalman filter, for any measurement model. No
/// allocation, no exception.
namespace palpate {

namespace detail {

/// Levenberg-Marquardt's damping after Nielsen: none while the model keeps its promises, twice as much with every
/// refusal in a row where it does not.
struct DampingRule {
  static constexpr double kLeast = 1e-3, kNegligible = 1e-6;
  double value = 0.0;
  double growth = 2.0;

  void accepted(double kept_share);
  void refused();
};

/// One accepted step downhill from `point`, or false where the steps run out first.
template <class W>
bool descend(W& whitened, DampingRule& damping, int max_evaluations, typename W::Point& point) {
  constexpr double kLeastKept = 1e-4, kMostDamping = 1e12;
  typename W::Point trial;
  while (whitened.evaluations < max_evaluations && damping.value < kMostDamping) {
    const typename W::Vector dz = whitened.damped_step(damping.value);
    const bool finite = whitened.evaluate(point.z + dz, trial);
    const double kept = finite ? (point.cost - trial.cost) / whitened.promised_fall(dz) : -1.0;
    if (kept > kLeastKept) {
      damping.accepted(kept);
      point = trial;
      return true;
    }
    damping.refused();
  }
  return false;
}

/// The full step, wherever it leads; false where the model has no answer there.
template <class W>
bool full_step(W& whitened, const typename W::Vector& dz, int max_evaluations, typename W::Point& point) {
  typename W::Point trial;
  if (whitened.evaluations >= max_evaluations || !whitened.evaluate(point.z + dz, trial)) return false;
  point = trial;
  return true;
}

/// When the next step can be taken unseen. Where steps shrink by the same factor or faster, the error left after one of
/// length d is theta / (1 - theta) d, theta = d / (length of the step before): an estimate, so a step of a sigma and
/// more is looked at all the same. Source: the stopping rule of simplified Newton iterations, Hairer and
/// Wanner, Solving Ordinary Differential Equations II, section IV.8.
class StoppingRule {
 public:
  explicit StoppingRule(double tolerance) : tolerance_(tolerance) {}
  /// `sigmas`: length of the next step. Below the tolerance it needs no history.
  bool last(double sigmas) const {
    return sigmas <= tolerance_ || (sigmas <= kMostUnseen && sigmas * sigmas <= tolerance_ * (before_ - sigmas));
  }
  /// A step was taken and the model evaluated there. After a damped one, or where weights change with the step,
  /// nothing is known of the next.
  void taken(double sigmas, bool full) { before_ = full ? sigmas : 0.0; }

 private:
  static constexpr double kMostUnseen = 1.0;
  double tolerance_, before_ = 0.0;
};

/// Nothing of an earlier update stays in `out`.
void begin(int rows, const Gaussian& prior, Update& out);

/// Steps downhill from `point` until the next one may be taken unseen: true; or until none leads on. Leaves the cost
/// modelled at the last point.
template <class W>
bool walk(W& whitened, const UpdateOptions& options, typename W::Point& point) {
  StoppingRule rule(options.step_tolerance);
  DampingRule damping;
  const bool free = options.damping == Damping::kNone;
  const int most = 1 + options.max_iterations;
  double sigmas = whitened.model_cost(point);
  while (!rule.last(sigmas) && sigmas >= 0.0) {
    const int before = whitened.evaluations;
    const bool undamped = free || damping.value == 0.0;
    if (!(free ? full_step(whitened, whitened.step(), most, point) : descend(whitened, damping, most, point))) break;
    const bool weighted = point.root_weight.size() > 0 && point.root_weight.minCoeff() < 1.0;
    rule.taken(sigmas, undamped && whitened.evaluations == before + 1 && !weighted);
    sigmas = whitened.model_cost(point);
    if (point.cost - sigmas * sigmas > options.hopeless_cost) break;
  }
  return rule.last(sigmas);
}

template <int N, MeasurementModel Model>
void iterate(Model& model, const Gaussian& prior, const StateVector& start, const UpdateOptions& options, Update& out) {
  Whitened<Model, N> whitened(model, prior, options.nuisance_states, options.tail_degrees);
  WhitenedPoint<N> point;
  const bool usable = whitened.definite() && whitened.evaluate(whitened.coordinates(start), point);
  out.evaluations = whitened.evaluations;
  if (!usable) return;

  out.innovation = point.at.residual;
  const bool last = walk(whitened, options, point);
  out.status = last ? UpdateStatus::kConverged : UpdateStatus::kNotConverged;
  out.line.x0 = whitened.state(point.z);
  out.line.at_x0 = point.at;
  whitened.add_tail_noise(point, out.line.more_noise);
  if (last) whitened.take(whitened.step(), point);
  whitened.conclude(point, whitened.evaluations, out);
}

template <int N, MeasurementModel Model>
void single_step(Model& model, const Gaussian& prior, int nuisance_states, Update& out) {
  Whitened<Model, N> whitened(model, prior, nuisance_states);
  WhitenedPoint<N> point;
  const auto origin = whitened.coordinates(prior.mean);
  const bool usable = whitened.definite() && whitened.evaluate(origin, point);
  out.evaluations = whitened.evaluations;
  if (!usable) return;

  out.innovation = point.at.residual;
  out.line.x0 = prior.mean;
  out.line.at_x0 = point.at;
  whitened.model_cost(point);
  const typename Sized<N>::Vector dz = whitened.step();
  const double chi_square = point.cost - whitened.squared_sigmas(dz);
  const bool finite = whitened.evaluate(dz, point);
  out.status = finite ? UpdateStatus::kConverged : UpdateStatus::kNotConverged;
  point.z = dz;
  whitened.conclude(point, whitened.evaluations, out);
  out.chi_square = chi_square;
  if (!finite) out.residual_chi_square = 0.0;
}

}  // namespace detail

/// Iterated extended Kalman update (paper, section 3.3.1): the maximum of the posterior by Gauss-Newton steps from
/// `start` (the prior mean, unless there is a better guess), damped after Levenberg and Marquardt. `out.posterior` is
/// the prior where the status is kFailed. At most 1 + max_iterations evaluations.
/// Sources: Bell and Cathey 1993; Madsen, Nielsen, Tingleff 2004.
template <MeasurementModel Model>
void iterated_update(Model& model, const Gaussian& prior, const StateVector& start, const UpdateOptions& options,
                     Update& out) {
  detail::begin(model.rows(), prior, out);
  if (prior.mean.size() == 3)
    detail::iterate<3>(model, prior, start, options, out);
  else
    detail::iterate<Eigen::Dynamic>(model, prior, start, options, out);
}

/// Extended Kalman update, Eq. (17): one step from the prior mean, and one evaluation more for the post-fit residual.
/// `nuisance_states`: as UpdateOptions.
template <MeasurementModel Model>
void extended_update(Model& model, const Gaussian& prior, Update& out, int nuisance_states = 0) {
  detail::begin(model.rows(), prior, out);
  if (prior.mean.size() == 3)
    detail::single_step<3>(model, prior, nuisance_states, out);
  else
    detail::single_step<Eigen::Dynamic>(model, prior, nuisance_states, out);
}

}  // namespace palpate
