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
    const StateVector dz = whitened.damped_step(damping.value);
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
bool full_step(W& whitened, const StateVector& dz, int max_evaluations, typename W::Point& point) {
  typename W::Point trial;
  if (whitened.evaluations >= max_evaluations || !whitened.evaluate(point.z + dz, trial)) return false;
  point = trial;
  return true;
}

/// Nothing of an earlier update stays in `out`.
void begin(int rows, const Gaussian& prior, Update& out);

}  // namespace detail

/// Iterated extended Kalman update (paper, section 3.3.1): the maximum of the posterior by Gauss-Newton steps from
/// `start` (the prior mean, unless there is a better guess), damped after Levenberg and Marquardt. `out.posterior` is
/// the prior where the status is kFailed. At most 1 + max_iterations evaluations.
/// Sources: Bell and Cathey 1993; Madsen, Nielsen, Tingleff 2004.
template <MeasurementModel Model>
void iterated_update(Model& model, const Gaussian& prior, const StateVector& start, const UpdateOptions& options,
                     Update& out) {
  detail::begin(model.rows(), prior, out);
  Whitened<Model> whitened(model, prior, options.nuisance_states, options.tail_degrees);
  typename Whitened<Model>::Point point;
  const bool usable = whitened.definite() && whitened.evaluate(whitened.coordinates(start), point);
  out.evaluations = whitened.evaluations;
  if (!usable) return;

  out.innovation = point.at.residual;
  whitened.model_cost(point);
  StateVector dz = whitened.step();
  detail::DampingRule damping;
  const double tolerance = options.step_tolerance * options.step_tolerance;
  const int most = 1 + options.max_iterations;
  while (whitened.squared_sigmas(dz) > tolerance) {
    const bool moved = options.damping == Damping::kNone ? detail::full_step(whitened, dz, most, point)
                                                         : detail::descend(whitened, damping, most, point);
    if (!moved) break;
    whitened.model_cost(point);
    dz = whitened.step();
  }
  out.status = UpdateStatus::kNotConverged;
  out.line.x0 = whitened.state(point.z);
  out.line.at_x0 = point.at;
  whitened.add_tail_noise(point, out.line.more_noise);
  if (whitened.squared_sigmas(dz) <= tolerance) {
    out.status = UpdateStatus::kConverged;
    point.z += dz;  // below the tolerance: taken without another evaluation
  }
  whitened.conclude(point, whitened.evaluations, out);
}

/// Extended Kalman update, Eq. (17): one step from the prior mean, and one evaluation more for the post-fit residual.
/// `nuisance_states`: as UpdateOptions.
template <MeasurementModel Model>
void extended_update(Model& model, const Gaussian& prior, Update& out, int nuisance_states = 0) {
  detail::begin(model.rows(), prior, out);
  Whitened<Model> whitened(model, prior, nuisance_states);
  typename Whitened<Model>::Point point;
  const StateVector origin = StateVector::Zero(prior.mean.size());
  const bool usable = whitened.definite() && whitened.evaluate(origin, point);
  out.evaluations = whitened.evaluations;
  if (!usable) return;

  out.innovation = point.at.residual;
  out.line.x0 = prior.mean;
  out.line.at_x0 = point.at;
  whitened.model_cost(point);
  const StateVector dz = whitened.step();
  const double chi_square = point.cost - whitened.squared_sigmas(dz);
  const bool finite = whitened.evaluate(dz, point);
  out.status = finite ? UpdateStatus::kConverged : UpdateStatus::kNotConverged;
  point.z = dz;
  whitened.conclude(point, whitened.evaluations, out);
  out.chi_square = chi_square;
  if (!finite) out.residual_chi_square = 0.0;
}

}  // namespace palpate
