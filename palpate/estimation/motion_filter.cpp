// SPDX-License-Identifier: Apache-2.0
#include <numbers>
#include <palpate/estimation/motion_filter.hpp>

namespace palpate {

namespace {

/// A line of no rows: nothing is said.
void clear(FrameLine& line, Eigen::Index parameters) {
  line.force_N.setZero();
  line.parameters.setZero(parameters);
  line.residual.resize(0);
  line.by_force.resize(0, 3);
  line.by_parameters.resize(0, parameters);
  line.noise.resize(0, 0);
  line.hidden.setZero();
  line.hiding_rows = 0;
}

/// Three more rows: the force alone, as `more` (a line of three) says.
void append(const FrameLine& more, FrameLine& line) {
  const Eigen::Index m = line.residual.size();
  line.residual.conservativeResize(m + 3);
  line.residual.tail<3>() = more.residual - more.by_force * line.force_N;
  line.by_force.conservativeResize(m + 3, 3);
  line.by_force.bottomRows<3>() = more.by_force;
  line.by_parameters.conservativeResize(m + 3, line.by_parameters.cols());
  line.by_parameters.bottomRows<3>().setZero();
  line.noise.conservativeResize(m + 3, m + 3);
  line.noise.bottomRows<3>().setZero();
  line.noise.rightCols<3>().setZero();
  line.noise.bottomRightCorner<3, 3>() = more.noise;
}

}  // namespace

MotionFilter::MotionFilter(const MotionOptions& motion, const ProcessNoiseOptions& noise,
                           const ParameterPrior& parameters)
    : model_(motion),
      parameters_(parameters),
      noise_(model_, noise),
      adapts_(motion.motion != ForceMotion::kGaussMarkov) {
  parameters_.initial(model_, belief_);
  before_ = ahead_ = belief_;
  BeliefModel::see(model_.seen(), belief_, seen_);
  clear(line_, parameters_.parameters());
}

MotionFilter::MotionFilter(const MotionOptions& motion, const Vector3d& drive, const ParameterPrior& parameters)
    : MotionFilter(motion, ProcessNoiseOptions::of(motion.motion), parameters) {
  adapts_ = false;
  step_.drive = drive;
}

/// The force is believed to be N(0, sigma^2) before any frame; right after a jump it may be twice as uncertain.
double MotionFilter::belief_N() const { return std::numbers::sqrt2 * model_.options().force_sigma_N; }

void MotionFilter::repeat_prediction() {
  belief_ = before_;
  parameters_.predict(model_, step_, belief_);
  BeliefModel::see(model_.seen(), belief_, seen_);
  limited_ = seen_.covariance.diagonal().head<3>().maxCoeff() > belief_N() * belief_N();
  if (limited_) limit_force(belief_N(), seen_);
  prior_ = {seen_.mean.head<3>(), seen_.covariance.topLeftCorner<3, 3>()};
}

const ForceGaussian& MotionFilter::predict(double dt_s) {
  before_ = belief_;
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

/// line_, and what is believed of any force, correct the prediction.
bool MotionFilter::correct() {
  if (limited_) append(line_of(likelihood_between(seen(), prior_), 0), line_);
  const bool good = line_.residual.size() > 0 && parameters_.update(model_.seen(), line_, belief_, correction_);
  if (!good) correction_.rows = 0;
  if (model_.options().motion == ForceMotion::kRhythm) rhythm_.observe(step_.dt_s, seen());
  return good;
}

bool MotionFilter::tune_and_correct(const ForceLikelihood& likelihood, bool jump) {
  step_.jump = jump;
  if (adapts_) {
    if (jump) noise_.jump();
    noise_.observe(likelihood, force_of(model_.oscillating(), belief_.motion));
    step_.drive = noise_.drive();
  }
  repeat_prediction();
  return correct();
}

bool MotionFilter::absorb(const FrameLine& line, bool jump) {
  constexpr double kAfterJump = 1.5;  // what is believed then is of the force before: the frame knows better, soon
  line_ = line;
  axial_hidden_ = hide_axial_force(jump ? kAfterJump * weak_force_N_ : weak_force_N_, axial_hidden_ && !jump,
                                   belief_.parameter_covariance, line_);
  return tune_and_correct(force_likelihood(line, parameters_.prior(), belief_), jump);
}

bool MotionFilter::absorb(const ForceLikelihood& likelihood, bool jump) {
  line_ = line_of(likelihood, parameters_.parameters());
  return tune_and_correct(likelihood, jump);
}

void MotionFilter::hold() {
  clear(line_, parameters_.parameters());
  correct();
}

ForceGaussian MotionFilter::forecast(double ahead_s) const {
  MotionStep ahead = step_;
  ahead.dt_s = ahead_s;
  ahead.jump = false;
  if (adapts_) ahead.drive = noise_.drive_ahead(ahead_s);
  ahead.rhythm = rhythm_.rhythm();
  ahead_ = belief_;
  parameters_.predict(model_, ahead, ahead_);
  return within_belief(newtons(ahead_), belief_N());
}

ForceGaussian MotionFilter::newtons(const Belief& belief) const {
  ForceGaussian force = force_of(model_.reported(), belief.motion);
  if (parameters_.parameters() == 0) return force;
  return in_newtons(parameters_.prior(), force, map_times(model_.reported(), belief.cross), belief.parameters,
                    belief.parameter_covariance);
}

}  // namespace palpate
