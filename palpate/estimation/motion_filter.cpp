// SPDX-License-Identifier: Apache-2.0
#include <numbers>
#include <palpate/estimation/motion_filter.hpp>

namespace palpate {

MotionFilter::MotionFilter(const MotionOptions& motion, const ProcessNoiseOptions& noise)
    : model_(motion), noise_(model_, noise), adapts_(motion.motion != ForceMotion::kGaussMarkov) {
  model_.initial(state_);
  before_ = state_;
}

MotionFilter::MotionFilter(const MotionOptions& motion, const Vector3d& drive)
    : MotionFilter(motion, ProcessNoiseOptions::of(motion.motion)) {
  adapts_ = false;
  step_.drive = drive;
}

/// The force is believed to be N(0, sigma^2) before any frame; right after a jump it may be twice as uncertain.
double MotionFilter::belief_N() const { return std::numbers::sqrt2 * model_.options().force_sigma_N; }

void MotionFilter::repeat_prediction() {
  state_ = before_;
  model_.predict(step_, state_);
  prior_ = within_belief(seen(), belief_N());
}

const ForceGaussian& MotionFilter::predict(double dt_s) {
  before_ = state_;
  step_.dt_s = dt_s;
  step_.jump = false;
  step_.rhythm = rhythm_.rhythm();
  if (adapts_) {
    // Of the frame before: whether the drive has changed since is for the frame at hand to say. With the chance of a
    // change mixed in, the prior of a force at rest would be far too wide, and the NIS too small.
    step_.drive = noise_.drive();
    noise_.predict(dt_s);
  }
  repeat_prediction();
  return prior_;
}

ForceGaussian MotionFilter::prior_after_jump() const {
  ForceGaussian out = prior_;
  out.covariance_N2.diagonal().array() += model_.options().force_sigma_N * model_.options().force_sigma_N;
  return out;
}

bool MotionFilter::correct(const ForceGaussian& posterior) {
  const bool good = condition(model_.seen(), posterior, state_, correction_);
  if (!good) correction_ = ForceCorrection::none(model_.seen());
  if (model_.options().motion == ForceMotion::kRhythm) rhythm_.observe(step_.dt_s, seen());
  return good;
}

bool MotionFilter::absorb(const ForceLikelihood& likelihood, bool jump) {
  step_.jump = jump;
  if (adapts_) {
    if (jump) noise_.jump();
    noise_.observe(likelihood, force_of(model_.oscillating(), state_));
    step_.drive = noise_.drive();
  }
  repeat_prediction();
  return correct(posterior_of(prior_, likelihood));
}

void MotionFilter::hold() { correct(prior_); }

ForceGaussian MotionFilter::forecast(double ahead_s) const {
  MotionStep ahead = step_;
  ahead.dt_s = ahead_s;
  ahead.jump = false;
  if (adapts_) ahead.drive = noise_.drive_ahead(ahead_s);
  ahead.rhythm = rhythm_.rhythm();
  return within_belief(model_.forecast(ahead, state_), belief_N());
}

}  // namespace palpate
