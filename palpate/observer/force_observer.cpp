// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <palpate/observer/force_observer.hpp>

namespace palpate {

Estimate ForceObserver::update(const TrackerFrame& frame) {
  evaluations_before_ = shape_.evaluations();
  used_ = 0;
  measurement_.rejections.fill(Rejection::kNone);
  const FrameClock::Step step = clock_.advance(frame.time_s);
  if (!step.accepted()) return report(frame.time_s, step.verdict, EstimateStatus::kRejected);

  predict(step.dt_s);
  if (frame.tendon.present) shape_.set_tendon_moment(frame.tendon.moment_Nm);
  register_frame(catheter_, frame, measurement_);
  const EstimateStatus status = explain_frame();
  return report(frame.time_s, step.verdict, status);
}

/// Random walk: the mean stays, P <- P + q^2 dt I; a gap so long that this exceeds the variance before the first frame
/// has made everything forgotten, and counts as that. Gauss-Markov, stationary at N(0, sigma^2 I):
/// F <- a F, P <- a^2 P + sigma^2 (1 - a^2) I, a = exp(-dt / memory).
void ForceObserver::predict(double dt_s) {
  if (options_.force_model == ForceModel::kGaussMarkov) {
    const double a = std::exp(-dt_s / options_.force_memory_s), sigma = options_.initial_force_sigma_N;
    state_.mean *= a;
    state_.covariance *= a * a;
    state_.covariance.diagonal().array() += sigma * sigma * (1.0 - a * a);
    return;
  }
  const double q = options_.force_rate_N_per_sqrt_s, forgotten = options_.initial_force_sigma_N;
  state_.covariance.diagonal().array() += std::min(q * q * dt_s, forgotten * forgotten);
}

/// The usual case first: all sensors, the prediction as prior. What does not fit it is looked into.
EstimateStatus ForceObserver::explain_frame() {
  unsigned present = 0;
  for (int k = 0; k < measurement_.count; ++k) present |= 1U << measurement_.poses[k].sensor;
  shape_.select(measurement_, present);
  if (shape_.rows() == 0) return EstimateStatus::kHeld;
  if (options_.method == Method::kEkf) {
    single_step(state_);
    if (update_.status == UpdateStatus::kConverged && agrees_with_prediction() && explains_sensors())
      return take(state_);
  }
  if (fit(present, state_, state_.mean) && agrees_with_prediction()) return accept(state_);
  return explain_surprise(present);
}

/// A frame far from the prediction means that the force has jumped, or that a sensor is wrong. Any force whatever is
/// allowed as an explanation; what no force explains with all sensors, it may explain without one of them.
EstimateStatus ForceObserver::explain_surprise(unsigned present) {
  Gaussian anywhere = state_;
  anywhere.covariance.diagonal().array() += options_.initial_force_sigma_N * options_.initial_force_sigma_N;
  const StateVector no_force = StateVector::Zero(state_.mean.size());
  for (const StateVector* start : std::initializer_list<const StateVector*>{&state_.mean, &no_force})
    if (fit(present, anywhere, *start) && agrees_with_itself()) return accept(anywhere);
  return explain_without_one_sensor(present, anywhere);
}

/// Leaves out each sensor in turn and keeps the best of the explanations that pass.
EstimateStatus ForceObserver::explain_without_one_sensor(unsigned present, const Gaussian& anywhere) {
  bool converged = update_.status == UpdateStatus::kConverged;
  double least_misfit = std::numeric_limits<double>::infinity();
  unsigned odd_one = 0;
  const Gaussian* prior = nullptr;
  for (unsigned left = present; left != 0; left &= left - 1) {
    const unsigned sensor = left & -left, rest = present & ~sensor;
    const Gaussian* candidate = nullptr;
    if (fit(rest, state_, state_.mean) && agrees_with_prediction())
      candidate = &state_;
    else if (fit(rest, anywhere, state_.mean) && agrees_with_itself())
      candidate = &anywhere;
    converged |= update_.status == UpdateStatus::kConverged;
    const double misfit = update_.chi_square / update_.rows;
    if (candidate == nullptr || misfit >= least_misfit) continue;
    least_misfit = misfit;
    odd_one = sensor;
    prior = candidate;
  }
  if (prior == nullptr) return converged ? EstimateStatus::kRejected : EstimateStatus::kNotConverged;
  measurement_.rejections[static_cast<std::size_t>(std::countr_zero(odd_one))] = Rejection::kOutlier;
  fit(present & ~odd_one, *prior, state_.mean);
  return accept(*prior);
}

bool ForceObserver::fit(unsigned sensors, const Gaussian& prior, const StateVector& start) {
  shape_.select(measurement_, sensors);
  if (shape_.rows() == 0) return false;
  AdaptedModel model{shape_, adaptation_ ? &*adaptation_ : nullptr};
  iterated_update(model, prior, start, {.max_iterations = options_.max_iterations}, update_);
  return update_.status == UpdateStatus::kConverged;
}

bool ForceObserver::agrees_with_prediction() const { return gate_.passes(update_.chi_square, update_.rows); }

/// The post-fit residual is no larger than the noise.
bool ForceObserver::explains_sensors() const { return gate_.passes(update_.residual_chi_square, update_.rows); }

/// More equations than unknowns, and the post-fit residual no larger than the noise.
bool ForceObserver::agrees_with_itself() const {
  const int surplus = update_.rows - static_cast<int>(state_.mean.size());
  return surplus > 0 && gate_.passes(update_.residual_chi_square, surplus);
}

/// The iterated fit has found sensors and prior good; the EKF then does its own single step on them. Where that step
/// ends at a force that does not explain the frame, the iterated fit is kept: a bad step would never be found again.
EstimateStatus ForceObserver::accept(const Gaussian& prior) {
  if (options_.method != Method::kEkf) return take(prior);
  const Update iterated = update_;
  single_step(prior);
  if (update_.status == UpdateStatus::kConverged && explains_sensors()) return take(prior);
  update_ = iterated;
  take(prior);
  return EstimateStatus::kReseeded;
}

void ForceObserver::single_step(const Gaussian& prior) {
  AdaptedModel model{shape_, adaptation_ ? &*adaptation_ : nullptr};
  extended_update(model, prior, update_);
}

/// Makes the latest update the state.
EstimateStatus ForceObserver::take(const Gaussian& prior) {
  AdaptedModel model{shape_, adaptation_ ? &*adaptation_ : nullptr};
  if (options_.report_convergence_index) {
    ResidualMatrix R;
    model.noise(R);
    convergence_ = convergence_index(update_.at.residual, update_.at.jacobian, prior.covariance, R);
  }
  if (adaptation_) {
    ResidualMatrix nominal;
    shape_.noise(nominal);
    adaptation_->observe(shape_.channels(), nominal, update_.at, update_.posterior.covariance);
  }
  state_ = update_.posterior;
  R_base_tip_ = shape_.T_base_tip().R;
  used_ = shape_.used();
  return EstimateStatus::kUpdated;
}

Estimate ForceObserver::report(double time_s, FrameTime time, EstimateStatus status) const {
  Estimate out;
  out.time_s = time_s;
  out.time = time;
  out.status = status;
  out.force_tip_N = state_.mean.head<3>();
  out.covariance_tip_N2 = state_.covariance.topLeftCorner<3, 3>();
  out.R_base_tip = R_base_tip_;
  out.force_base_N = R_base_tip_ * out.force_tip_N;
  out.rejections = measurement_.rejections;
  out.evaluations = static_cast<int>(shape_.evaluations() - evaluations_before_);
  if (used_ == 0) return out;
  out.used = used_;
  out.sensors_used = std::popcount(used_);
  out.innovation = update_.innovation;
  out.nis = update_.chi_square;
  out.dof = update_.rows;
  out.convergence = convergence_;
  return out;
}

ForceObserver::ForceObserver(const Catheter& catheter, const ObserverOptions& options)
    : catheter_(catheter),
      options_(options),
      gate_(options.outlier_probability > 0.0 ? options.outlier_probability : 1e-300),
      shape_(catheter, options.measurement) {
  options_.validate();
  if (options_.method == Method::kIaekf) adaptation_.emplace(ShapeModel::kChannels, options_.adaptation_window);
  state_.mean.setZero(3);
  state_.covariance = options_.initial_force_sigma_N * options_.initial_force_sigma_N * StateMatrix::Identity(3, 3);
  Linearization at;
  shape_.linearize(state_.mean, at);
  R_base_tip_ = shape_.T_base_tip().R;
}

void ForceObserver::AdaptedModel::noise(ResidualMatrix& R) const {
  shape.noise(R);
  if (adaptation != nullptr) adaptation->apply(shape.channels(), R);
}

std::string_view describe(EstimateStatus status) {
  constexpr std::array<std::string_view, kEstimateStatuses> words{"UPDATED", "RESEEDED",      "AMBIGUOUS", "REJECTED",
                                                                  "HELD",    "NOT_CONVERGED", "STALE"};
  return words[static_cast<std::size_t>(status)];
}

}  // namespace palpate
