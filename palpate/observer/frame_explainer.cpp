// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <limits>
#include <palpate/estimation/unscented.hpp>
#include <palpate/observer/frame_explainer.hpp>

namespace palpate {

namespace {

constexpr int kSearch = 200, kShortSearch = 60;  ///< evaluations: all sensors; with one sensor left out
constexpr int kInsists = 3;                      ///< surprising frames in a row

UpdateOptions local_options(const ObserverOptions& options, int nuisance_states) {
  return {.max_iterations = options.max_iterations,
          .tail_degrees = options.noise_tail_degrees,
          .nuisance_states = nuisance_states};
}

ObserverOptions validated(const ObserverOptions& options) {
  options.validate();
  return options;
}

bool is_single_step(Method method) { return method == Method::kEkf || method == Method::kUkf; }

EstimateStatus status_of(UpdateStatus status) {
  if (status == UpdateStatus::kReseeded) return EstimateStatus::kReseeded;
  if (status == UpdateStatus::kAmbiguous) return EstimateStatus::kAmbiguous;
  return EstimateStatus::kUpdated;
}

}  // namespace

FrameExplainer::FrameExplainer(const Catheter& catheter, const ObserverOptions& options,
                               const UncertainParameters& parameters)
    : options_(validated(options)),
      local_(local_options(options, parameters.rod_count)),
      outlier_gate_(options.outlier_probability),
      jump_gate_(options.jump_probability),
      search_({.local = local_, .max_evaluations = kSearch}),
      short_search_({.local = local_, .max_evaluations = kShortSearch}),
      shape_(catheter, options.measurement, parameters) {
  line_.parameters.setZero(parameters.size());
  SeenBelief any;  // the priors get their sizes
  any.mean.setZero(3 + parameters.size());
  any.covariance.setIdentity(3 + parameters.size(), 3 + parameters.size());
  for (FramePrior* prior : {&prediction_, &anywhere_}) prior->set(any, shape_.states());
  if (options_.method == Method::kIaekf) adaptation_.emplace(ShapeModel::kChannels, options_.adaptation_window);
}

int FrameExplainer::most_evaluations(const ObserverOptions& options, int sensors, int states) {
  const int own_update = 1 + options.max_iterations + (is_single_step(options.method) ? 2 * states + 1 : 0);
  // With one evaluation left, a search still begins a seed and then, from that seed, an update.
  const int late = ForceSeeds::kMostEvaluations + ForceSeeds::kDirections + options.max_iterations;
  const int again = 1 + options.max_iterations;  // where the update was given up too early
  return own_update + kSearch + late + again + sensors * (own_update + kShortSearch + late + again) + 2;
}

EstimateStatus FrameExplainer::explain(Measurement& measurement, const SeenBelief& prediction) {
  measurement_ = &measurement;
  used_ = 0;
  jumped_ = searched_ = false;
  unsigned present = 0;
  for (int k = 0; k < measurement.count; ++k) present |= 1U << measurement.poses[k].sensor;
  shape_.select(measurement, present);
  if (shape_.rows() == 0) return EstimateStatus::kHeld;
  prediction_.set(prediction, states());
  if (fits_prediction(present)) return take(prediction_, present);

  anywhere_.set(prediction, states(), options_.initial_force_sigma_N);
  if (shape_.rows() <= kForceStates) return explain_lone_point(present);
  jumped_ = true;
  if (!fits_any_force(present, search_)) return explain_without_one_sensor(measurement, present);
  jumped_ = !fits_prediction_after_all();
  return take(jumped_ ? anywhere_ : prediction_, present);
}

/// The usual case: the filter's own update, and nothing about it is surprising. Where a single step (EKF, UKF) does not
/// get there, an iterated update may.
bool FrameExplainer::fits_prediction(unsigned sensors) {
  shape_.select(*measurement_, sensors);
  searched_ = false;
  if (shape_.rows() == 0) return false;
  FrameModel frame = model(prediction_);
  const Gaussian& prior = prediction_.x;
  if (options_.method == Method::kEkf) extended_update(frame, prior, update_, local_.nuisance_states);
  if (options_.method == Method::kUkf) unscented_update(frame, prior, update_, local_.nuisance_states);
  if (is_single_step(options_.method)) {
    if (converged(update_.status) && agrees_with_prediction() && agrees_with_itself()) return true;
    searched_ = true;
  }
  local_.hopeless_cost = hopeless_cost();
  iterated_update(frame, prior, prior.mean, local_, update_);
  given_up_ = update_.status == UpdateStatus::kNotConverged;
  return converged(update_.status) && agrees_with_prediction();
}

/// Twice what agrees_with_prediction() lets pass. The promise of a step may be off: fits_prediction_after_all().
double FrameExplainer::hopeless_cost() const {
  constexpr double kMargin = 2.0;
  const int spare = shape_.rows() - kForceStates;
  if (spare <= 0) return std::numeric_limits<double>::infinity();
  return kMargin * (jump_gate_.threshold(kForceStates) + outlier_gate_.threshold(spare));
}

/// The fit from the prediction was given up. Where the force found without it lies where it was predicted, it was wrong
/// to do so: once more, from there.
bool FrameExplainer::fits_prediction_after_all() {
  if (!given_up_) return false;
  const Vector3d moved = update_.posterior.mean.head<3>() - prediction_.x.mean.head<3>();
  const Matrix3d spread =
      update_.posterior.covariance.topLeftCorner<3, 3>() + prediction_.x.covariance.topLeftCorner<3, 3>();
  if (!jump_gate_.passes(moved.dot(spread.llt().solve(moved)), kForceStates)) return false;
  const Update found = update_;
  FrameModel frame = model(prediction_);
  iterated_update(frame, prediction_.x, found.posterior.mean, local_, update_);
  if (converged(update_.status) && agrees_with_prediction()) return true;
  update_ = found;
  return false;
}

bool FrameExplainer::fits_any_force(unsigned sensors, GlobalUpdate& search) {
  shape_.select(*measurement_, sensors);
  searched_ = true;
  if (shape_.rows() == 0) return false;
  FrameModel frame = model(anywhere_);
  // What the prediction held back stands nearer to the force than the prediction itself.
  start_ = update_.status == UpdateStatus::kFailed ? anywhere_.x.mean : update_.posterior.mean;
  search.run(frame, anywhere_.x, &start_, update_);
  return converged(update_.status) && agrees_with_itself();
}

/// No more numbers than unknowns: any force would explain them, so a jump cannot be told from an outlier. The search
/// stays within the prediction, for its own update may have ended in a wrong minimum; only a point that insists, frame
/// after frame, is believed against it.
EstimateStatus FrameExplainer::explain_lone_point(unsigned sensors) {
  jumped_ = ++surprises_in_a_row_ >= kInsists;
  searched_ = true;
  const FramePrior& prior = jumped_ ? anywhere_ : prediction_;
  FrameModel frame = model(prior);
  search_.run(frame, prior.x, &prior.x.mean, update_);
  if (!converged(update_.status)) return EstimateStatus::kNotConverged;
  return agrees_with_prediction() ? take(prior, sensors) : EstimateStatus::kRejected;
}

/// Without one sensor the prediction is tried first, then any force; explanations that keep the prediction come before
/// those that do not, the smaller misfit before the larger.
EstimateStatus FrameExplainer::explain_without_one_sensor(Measurement& measurement, unsigned present) {
  bool any_converged = converged(update_.status);
  double least_misfit = std::numeric_limits<double>::infinity();
  unsigned odd_one = 0;
  bool best_searched = false;
  jumped_ = true;
  for (unsigned left = present; left != 0; left &= left - 1) {
    const unsigned sensor = left & -left, rest = present & ~sensor;
    bool calm = fits_prediction(rest);
    const bool passes = calm || (jumped_ && fits_any_force(rest, short_search_));
    if (passes && !calm) calm = fits_prediction_after_all();
    any_converged |= converged(update_.status);
    const double misfit = update_.chi_square / update_.rows;
    if (!passes || (calm != jumped_ && misfit >= least_misfit)) continue;
    spare_ = update_;
    best_searched = searched_;
    least_misfit = misfit;
    odd_one = sensor;
    jumped_ = !calm;  // where one passes calmly, so does the one that stands
  }
  if (odd_one == 0) return any_converged ? EstimateStatus::kRejected : EstimateStatus::kNotConverged;
  measurement.rejections[static_cast<std::size_t>(std::countr_zero(odd_one))] = Rejection::kOutlier;
  update_ = spare_;
  searched_ = best_searched;
  shape_.select(measurement, present & ~odd_one);
  return take(jumped_ ? anywhere_ : prediction_, present & ~odd_one);
}

/// Neither the force moves farther than the prediction allows, nor do the sensors contradict each other. Where there is
/// nothing to spare, only both together can be judged.
bool FrameExplainer::agrees_with_prediction() const {
  if (surplus() <= 0) return outlier_gate_.passes(update_.chi_square, update_.rows);
  const double misfit = update_.chi_square - update_.surprise;
  return jump_gate_.passes(update_.surprise, kForceStates) && outlier_gate_.passes(misfit, surplus());
}

/// More equations than unknowns, and the post-fit residual no larger than the noise.
bool FrameExplainer::agrees_with_itself() const {
  return surplus() > 0 && outlier_gate_.passes(update_.residual_chi_square, surplus());
}

/// The latest update stands.
EstimateStatus FrameExplainer::take(const FramePrior& prior, unsigned sensors) {
  surprises_in_a_row_ = 0;
  const FrameModel frame = model(prior);
  frame.line(update_.line, line_);
  if (options_.report_convergence_index) {
    ResidualMatrix R;
    frame.noise(R);
    convergence_ = convergence_index(update_.at.residual, update_.at.jacobian, prior.x.covariance, R);
  }
  if (adaptation_) {
    ResidualMatrix nominal;
    shape_.noise(nominal);
    adaptation_->observe(shape_.channels(), nominal, update_.at, update_.posterior.covariance);
  }
  used_ = sensors & shape_.used();
  // After a search the rod's latest shape may be that of another force.
  const StateVector &seen_at = shape_.linearized_at(), &mean = update_.posterior.mean;
  R_base_tip_ = seen_at == update_.line.x0 || seen_at == mean ? shape_.R_base_tip_near(mean) : R_base_tip(mean);
  const bool own_step = !searched_ || !is_single_step(options_.method);
  const EstimateStatus status = status_of(update_.status);
  return own_step || status != EstimateStatus::kUpdated ? status : EstimateStatus::kReseeded;
}

Matrix3d FrameExplainer::R_base_tip(const StateVector& x) {
  Linearization unused;
  shape_.linearize(x, unused);
  return shape_.T_base_tip().R;
}

}  // namespace palpate
