// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <limits>
#include <palpate/observer/force_observer.hpp>

namespace palpate {

Estimate ForceObserver::update(const TrackerFrame& frame) {
  evaluations_before_ = explainer_.evaluations();
  updated_ = false;
  measurement_.rejections.fill(Rejection::kNone);
  const FrameClock::Step step = clock_.advance(frame.time_s);
  if (!step.accepted()) return report(frame.time_s, step.verdict, EstimateStatus::kRejected);

  take_loads(frame);
  motion_.predict(step.dt_s);
  register_frame(catheter_, frame, measurement_);
  const EstimateStatus status = explainer_.explain(measurement_, motion_.seen_prior());
  updated_ = status <= EstimateStatus::kAmbiguous;
  if (updated_) {
    motion_.absorb(explainer_.line(), explainer_.jumped());
    R_base_tip_ = explainer_.R_base_tip();
    observability_ = uncertainty_.observability(explainer_.line(), motion_.belief(), R_base_tip_);
  } else {
    motion_.hold();
  }
  look_back(frame.time_s);
  return report(frame.time_s, step.verdict, status);
}

/// What acts on the shaft besides the tissue, as far as the frame knows it: handle, tendon, an episode of known load.
void ForceObserver::take_loads(const TrackerFrame& frame) {
  explainer_.set_known_load(frame.known_load);
  take_bend(frame.bend);
  if (frame.bend.present) return explainer_.set_tendon_moment(Eigen::Vector2d::Zero());  // it would bend twice
  if (!frame.tendon.present) return;
  explainer_.set_tendon_moment(frame.tendon.moment_Nm);
  const int noise = parameters_.find(ParameterKind::kTendonMoment, 0);
  for (int axis = 0; noise >= 0 && axis < 2; ++axis)
    motion_.set_sigma(noise + axis, std::max(frame.tendon.sigma_Nm, kLeastTendonNoise_Nm));
}

void ForceObserver::take_bend(const BendReading& bend) {
  if (!bend.present) return;
  explainer_.set_bend(bend);
  if (bend.change_per_m.allFinite()) bend_per_m_ = bend.change_per_m;
}

void ForceObserver::look_back(double time_s) {
  if (!lag_) return;
  lag_->push(motion_.step(), motion_.correction(), motion_.belief());
  times_s_[frames_++ % times_s_.size()] = time_s;
}

Estimate ForceObserver::report(double time_s, FrameTime time, EstimateStatus status) {
  Estimate out;
  out.time_s = time_s;
  out.time = time;
  out.status = status;
  const ForceGaussian force = motion_.reported();
  out.force_tip_N = force.mean_N;
  out.covariance_tip_N2 = force.covariance_N2;
  out.sigma_by_source_N = uncertainty_.budget(motion_.model().reported(), motion_.belief());
  out.shaft = uncertainty_.shaft(motion_.belief().parameters, motion_.belief().parameter_covariance);
  out.shaft.precurvature_per_m.head<2>() += bend_per_m_;
  out.observability = observability_;
  out.R_base_tip = R_base_tip_;
  out.force_base_N = R_base_tip_ * out.force_tip_N;
  out.rejections = measurement_.rejections;
  out.evaluations = static_cast<int>(explainer_.evaluations() - evaluations_before_);
  if (options_.forecast_s > 0.0) out.forecast = motion_.forecast(options_.forecast_s);
  if (lag_ && lag_->available() > 0) {
    const int age = lag_->available() - 1;
    out.lagged = {age, times_s_[(frames_ - 1 - static_cast<std::size_t>(age)) % times_s_.size()],
                  lag_->force(age, motion_.belief())};
  }
  if (!updated_) return out;
  const Update& update = explainer_.update();
  out.used = explainer_.used();
  out.sensors_used = std::popcount(out.used);
  out.jumped = explainer_.jumped();
  out.innovation = update.innovation;
  out.nis = update.chi_square;
  out.dof = update.rows;
  out.convergence = explainer_.convergence();
  return out;
}

namespace {

MotionFilter motion_filter(const ObserverOptions& options, const ParameterPrior& parameters) {
  const double drive = options.stated_drive();
  if (drive > 0.0) return {options.motion(), Vector3d::Constant(drive), parameters};
  return {options.motion(), ProcessNoiseOptions::of(options.force_model), parameters};
}

}  // namespace

ForceObserver::ForceObserver(const Catheter& catheter, const ObserverOptions& options)
    : catheter_(catheter),
      options_(options),
      parameters_(uncertain_parameters(catheter, options.parameters())),
      uncertainty_(catheter, options, parameters_),
      explainer_(catheter, options, parameters_),
      motion_(motion_filter(options, uncertainty_.prior())) {
  motion_.set_weak_force(uncertainty_.weak_force_N());
  // Before the first frame that is used nothing was seen.
  observability_.axial_force_hidden = observability_.lateral_force_hidden = true;
  observability_.weakest_sigmas = std::numeric_limits<double>::infinity();
  R_base_tip_ = explainer_.R_base_tip(StateVector::Zero(explainer_.states()));
  if (options_.smoothing_lag_frames == 0) return;
  lag_.emplace(motion_.model(), options_.smoothing_lag_frames, uncertainty_.prior());
  times_s_.resize(static_cast<std::size_t>(options_.smoothing_lag_frames) + 1);
}

Matrix3d ForceObserver::R_base_tip(const Vector3d& force_tip_N, const TendonReading& tendon, const BendReading& bend) {
  take_bend(bend);
  if (tendon.present) explainer_.set_tendon_moment(tendon.moment_Nm);
  StateVector x(explainer_.states());
  x << uncertainty_.followed(force_tip_N, motion_.belief()), motion_.belief().parameters.head(parameters_.rod_count);
  return explainer_.R_base_tip(x);
}

std::string_view describe(EstimateStatus status) {
  constexpr std::array<std::string_view, kEstimateStatuses> words{"UPDATED", "RESEEDED",      "AMBIGUOUS", "REJECTED",
                                                                  "HELD",    "NOT_CONVERGED", "STALE"};
  return words[static_cast<std::size_t>(status)];
}

}  // namespace palpate
