// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <palpate/observer/force_observer.hpp>

namespace palpate {

Estimate ForceObserver::update(const TrackerFrame& frame) {
  evaluations_before_ = explainer_.evaluations();
  updated_ = false;
  measurement_.rejections.fill(Rejection::kNone);
  const FrameClock::Step step = clock_.advance(frame.time_s);
  if (!step.accepted()) return report(frame.time_s, step.verdict, EstimateStatus::kRejected);

  const ForceGaussian prediction = motion_.predict(step.dt_s);
  if (frame.tendon.present) explainer_.set_tendon_moment(frame.tendon.moment_Nm);
  register_frame(catheter_, frame, measurement_);
  const EstimateStatus status = explainer_.explain(measurement_, {prediction.mean_N, prediction.covariance_N2});
  updated_ = status <= EstimateStatus::kAmbiguous;
  if (updated_) {
    motion_.absorb(explainer_.likelihood(), explainer_.jumped());
    R_base_tip_ = explainer_.R_base_tip();
  } else {
    motion_.hold();
  }
  look_back(frame.time_s);
  return report(frame.time_s, step.verdict, status);
}

void ForceObserver::look_back(double time_s) {
  if (!lag_) return;
  lag_->push(motion_.step(), motion_.correction(), motion_.state());
  times_s_[frames_++ % times_s_.size()] = time_s;
}

Estimate ForceObserver::report(double time_s, FrameTime time, EstimateStatus status) const {
  Estimate out;
  out.time_s = time_s;
  out.time = time;
  out.status = status;
  const ForceGaussian force = motion_.reported();
  out.force_tip_N = force.mean_N;
  out.covariance_tip_N2 = force.covariance_N2;
  out.R_base_tip = R_base_tip_;
  out.force_base_N = R_base_tip_ * out.force_tip_N;
  out.rejections = measurement_.rejections;
  out.evaluations = static_cast<int>(explainer_.evaluations() - evaluations_before_);
  if (options_.forecast_s > 0.0) out.forecast = motion_.forecast(options_.forecast_s);
  if (lag_ && lag_->available() > 0) {
    const int age = lag_->available() - 1;
    out.lagged = {age, times_s_[(frames_ - 1 - static_cast<std::size_t>(age)) % times_s_.size()], lag_->force(age)};
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

MotionFilter motion_filter(const ObserverOptions& options) {
  const double drive = options.stated_drive();
  if (drive > 0.0) return {options.motion(), Vector3d::Constant(drive)};
  return {options.motion(), ProcessNoiseOptions::of(options.force_model)};
}

}  // namespace

ForceObserver::ForceObserver(const Catheter& catheter, const ObserverOptions& options)
    : catheter_(catheter), options_(options), explainer_(catheter, options), motion_(motion_filter(options)) {
  R_base_tip_ = explainer_.R_base_tip(Vector3d::Zero());
  if (options_.smoothing_lag_frames == 0) return;
  lag_.emplace(motion_.model(), options_.smoothing_lag_frames);
  times_s_.resize(static_cast<std::size_t>(options_.smoothing_lag_frames) + 1);
}

Matrix3d ForceObserver::R_base_tip(const Vector3d& force_tip_N, const TendonReading& tendon) {
  if (tendon.present) explainer_.set_tendon_moment(tendon.moment_Nm);
  return explainer_.R_base_tip(force_tip_N);
}

std::string_view describe(EstimateStatus status) {
  constexpr std::array<std::string_view, kEstimateStatuses> words{"UPDATED", "RESEEDED",      "AMBIGUOUS", "REJECTED",
                                                                  "HELD",    "NOT_CONVERGED", "STALE"};
  return words[static_cast<std::size_t>(status)];
}

}  // namespace palpate
