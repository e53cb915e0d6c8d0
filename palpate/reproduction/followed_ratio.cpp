// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <palpate/reproduction/followed_ratio.hpp>

namespace palpate::reproduction {

namespace {

Catheter believed(Catheter catheter, const Start& start) {
  catheter.rod.sections.front().stiffness_Nm2 *= start.stiffness_factor;
  catheter.stiffness_sigma_fraction = start.stiffness_sigma;
  for (Sensor& sensor : catheter.sensors) {
    sensor.noise_m.setConstant(std::sqrt(paper_noise()(0)));
    sensor.noise_rad = std::sqrt(paper_noise()(3));
  }
  return catheter;
}

}  // namespace

Run follow_ratio(const Catheter& catheter, const Course& course, double Q_N2, const Start& start) {
  const Catheter file = believed(catheter, start);
  const UncertainParameters parameters = uncertain_parameters(file, {.estimate_stiffness = true});
  ShapeModel model(file, MeasurementKind::kTipAndCurvature, parameters, Accuracy::kReference);
  const Eigen::Vector2d EI_Nm2 = file.rod.sections.front().stiffness_Nm2.head<2>();
  Eigen::Matrix<double, 3, 2> exponent;
  for (int axis = 0; axis < 2; ++axis)
    exponent.col(axis) = force_exponent({.kind = ParameterKind::kLogStiffness, .axis = axis});

  Gaussian state{StateVector::Zero(5), Q_N2 * StateMatrix::Identity(5, 5)};
  state.mean.head<3>() = start.force_tip_N;
  state.covariance.bottomRightCorner<2, 2>() = parameters.covariance.topLeftCorner<2, 2>();
  Run run;
  Update update;
  for (std::size_t k = 0; k < course.size(); ++k) {
    state.covariance.diagonal().head<3>().array() += Q_N2;
    model.select(course.data[k], ~0U);
    iterated_update(model, state, state.mean, {.max_iterations = 60, .step_tolerance = 1e-7}, update);
    state = update.posterior;
    const Eigen::Vector2d log_EI = state.mean.tail<2>();
    const Vector3d scale = (exponent * log_EI).array().exp();
    run.error_N.emplace_back(scale.cwiseProduct(state.mean.head<3>()) - course.force_tip_N[k]);
    run.stiffness_Nm2.emplace_back(EI_Nm2.array() * log_EI.array().exp());
    run.unconverged += converged(update.status) ? 0 : 1;
  }
  return run;
}

}  // namespace palpate::reproduction
