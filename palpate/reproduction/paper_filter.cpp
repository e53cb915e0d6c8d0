// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numeric>
#include <palpate/reproduction/paper_filter.hpp>

namespace palpate::reproduction {

namespace {

constexpr int kDampedIterations = 60;

UncertainParameters parameters(const Catheter& catheter, bool stiffness) {
  if (!stiffness) return {};
  return uncertain_parameters(catheter, {.estimate_stiffness = true});
}

Channels rows_as_channels() {
  Channels channels{};
  std::iota(channels.begin(), channels.end(), 0);
  return channels;
}

StateMatrix process_noise(const PaperOptions& options) {
  StateVector q(options.stiffness ? 5 : 3);
  q.head<3>().setConstant(options.Q_N2);
  if (options.stiffness) q.tail<2>().setConstant(options.Q_stiffness_Nm2);
  return q.asDiagonal();
}

}  // namespace

PaperModel::PaperModel(const Catheter& catheter, bool stiffness, const PaperNoise& noise, Accuracy accuracy)
    : stiffness_(stiffness),
      nominal_Nm2_(catheter.rod.sections.front().stiffness_Nm2.head<2>()),
      noise_(noise),
      shape_(catheter, MeasurementKind::kTipAndCurvature, parameters(catheter, stiffness), accuracy) {
  for (int axis = 0; axis < 2; ++axis)
    exponent_.col(axis) = force_exponent({.kind = ParameterKind::kLogStiffness, .axis = axis});
}

/// (F, EI1, EI2) -> (f, log EI1 / EI1_0, log EI2 / EI2_0), the state of ShapeModel.
StateVector PaperModel::shape_state(const StateVector& x) const {
  if (!stiffness_) return x;
  StateVector y(5);
  y.tail<2>() = (x.tail<2>().array() / nominal_Nm2_.array()).log();
  y.head<3>() = x.head<3>().array() * (-exponent_ * y.tail<2>()).array().exp();
  return y;
}

/// By the chain rule: df / dF = exp(-E l), df / dl = -f E, dl / dEI = 1 / EI.
bool PaperModel::linearize(const StateVector& x, Linearization& at) {
  if (!stiffness_) return shape_.linearize(x, at);
  if (!(x.tail<2>().minCoeff() > 0.0)) return false;
  const StateVector y = shape_state(x);
  if (!shape_.linearize(y, at)) return false;
  for (int i = 0; i < 2; ++i) {
    const Vector3d df = -y.head<3>().cwiseProduct(exponent_.col(i));
    at.jacobian.col(3 + i) += at.jacobian.leftCols<3>() * df;
    at.jacobian.col(3 + i) /= x(3 + i);
  }
  const Vector3d scale = (-exponent_ * y.tail<2>()).array().exp();
  at.jacobian.leftCols<3>() *= scale.asDiagonal();
  return true;
}

bool PaperModel::seed(int k, StateVector& x, int& evaluations) {
  StateVector y = shape_state(x);
  if (!shape_.seed(k, y, evaluations)) return false;
  x.head<3>() = y.head<3>();
  if (stiffness_) x.head<3>().array() *= (exponent_ * y.tail<2>()).array().exp();
  return true;
}

PaperFilter::PaperFilter(const Catheter& catheter, const PaperOptions& options)
    : options_(options),
      nominal_Nm2_(catheter.rod.sections.front().stiffness_Nm2.head<2>()),
      model_(catheter, options.stiffness, options.R, options.accuracy),
      adaptation_(9, options.window, options.adaptation),
      search_({.local = {.max_iterations = kDampedIterations, .step_tolerance = options.step_tolerance}}) {
  start(Vector3d::Zero());
}

Gaussian PaperFilter::initial(const Vector3d& force_tip_N) const {
  StateVector x0(model_.states());
  x0.head<3>() = force_tip_N;
  if (options_.stiffness) x0.tail<2>() = nominal_Nm2_;
  return {x0, process_noise(options_)};
}

void PaperFilter::start(const Gaussian& state) {
  state_ = state;
  adaptation_ = NoiseAdaptation(9, options_.window, options_.adaptation);
}

const PaperStep& PaperFilter::update(const Measurement& measurement) {
  model_.select(measurement);
  step_.prior = {state_.mean, state_.covariance + process_noise(options_)};
  step_.R = options_.R;
  const bool adapts = options_.method == PaperMethod::kIaekf;
  for (int i = 0; adapts && i < 9; ++i) step_.R(i) *= adaptation_.ratio(i);
  model_.set_noise(step_.R);
  step_.rho = {};
  if (model_.rows() == 0) {
    detail::begin(0, step_.prior, step_.update);
  } else {
    solve();
    judge();
  }
  state_ = step_.update.posterior;
  return step_;
}

void PaperFilter::solve() {
  const Gaussian& prior = step_.prior;
  if (options_.method == PaperMethod::kEkf) {
    extended_update(model_, prior, step_.update);
    return;
  }
  const bool paper = options_.iteration == Iteration::kPaper;
  const UpdateOptions update{.max_iterations = paper ? options_.iterations : kDampedIterations,
                             .step_tolerance = options_.step_tolerance,
                             .damping = paper ? Damping::kNone : Damping::kLevenbergMarquardt};
  if (options_.iteration == Iteration::kGlobal)
    search_.run(model_, prior, &prior.mean, step_.update);
  else
    iterated_update(model_, prior, prior.mean, update, step_.update);
}

/// Convergence indices of section 4.2, and the noise sample of Eq. (19) for the next step.
void PaperFilter::judge() {
  const Update& update = step_.update;
  if (update.status == UpdateStatus::kFailed) return;
  const ResidualMatrix noise = step_.R.head(model_.rows()).asDiagonal();
  step_.rho = convergence_index(update.at.residual, update.at.jacobian, step_.prior.covariance, noise);
  if (options_.method != PaperMethod::kIaekf) return;
  static const Channels channels = rows_as_channels();
  const ResidualMatrix nominal = options_.R.head(model_.rows()).asDiagonal();
  adaptation_.observe(channels, nominal, update.at, update.posterior.covariance);
}

}  // namespace palpate::reproduction
