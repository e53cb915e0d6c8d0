// SPDX-License-Identifier: Apache-2.0
#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <palpate/identification/registration_fit.hpp>
#include <palpate/identification/registration_noise.hpp>

namespace palpate {

namespace {

constexpr double kBendPrior_per_m = 1.0;  // of k2 where it must tell the roll and the file does not say how well

bool has_pose_sensor(const RegistrationModel& model) {
  return std::any_of(model.readings().begin(), model.readings().end(),
                     [](const RegistrationReading& reading) { return reading.rows == 6; });
}

double or_fixed(double sigma) { return sigma > 0.0 ? sigma : RegistrationWeights::kFixed; }

/// A common roll of base and sensors bends the same shaft about other axes: nothing tells it, so one sensor must.
void hold_first_roll(const RegistrationModel& model, Eigen::VectorXd& sigma) {
  for (const RegistrationReading& reading : model.readings()) {
    if (reading.rows != 6) continue;
    sigma(model.mount_column(reading.sensor) + 5) = RegistrationWeights::kFixed;
    return;
  }
}

/// All unknowns as one block of parameters.
class RegistrationCost : public ceres::CostFunction {
 public:
  RegistrationCost(RegistrationModel& model, const RegistrationWeights& weights, const RegistrationState& from)
      : model_(model), weights_(weights), from_(from) {
    set_num_residuals(model.rows() + model.unknowns());
    mutable_parameter_block_sizes()->push_back(model.unknowns());
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(parameters[0], model_.unknowns());
    WhitenedRegistration at;
    if (!whiten(model_, weights_, from_, x, at)) return false;
    Eigen::Map<Eigen::VectorXd>(residuals, at.residual.size()) = at.residual;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    if (jacobians != nullptr && jacobians[0] != nullptr)
      Eigen::Map<RowMajor>(jacobians[0], at.jacobian.rows(), at.jacobian.cols()) = at.jacobian;
    return true;
  }

 private:
  RegistrationModel& model_;
  const RegistrationWeights& weights_;
  const RegistrationState& from_;
};

}  // namespace

RegistrationWeights weights_of(const RegistrationModel& model, const RegistrationOptions& options) {
  RegistrationWeights weights;
  weights.noise_factor = registration_noise(model).llt().matrixL();
  Eigen::VectorXd& sigma = weights.prior_sigma;
  sigma = Eigen::VectorXd::Constant(model.unknowns(), RegistrationWeights::kFree);
  const Catheter& catheter = model.catheter();
  sigma(RegistrationModel::kTwistColumn) = or_fixed(catheter.precurvature_sigma_per_m.z());
  if (!has_pose_sensor(model)) {
    const double stated = catheter.precurvature_sigma_per_m.y();
    for (int j = 0; j < model.positions(); ++j)
      sigma(RegistrationModel::bend_column(j) + 1) = stated > 0.0 ? stated : kBendPrior_per_m;
  }
  if (!model.mounting()) return weights;
  for (int i = 0; i < model.sensors(); ++i) {
    const Sensor& sensor = catheter.sensors[static_cast<std::size_t>(i)];
    const bool turns = sensor.kind != SensorKind::kPosition;
    sigma.segment<3>(model.mount_column(i))
        .setConstant(sensor.mount_sigma_m > 0.0 ? sensor.mount_sigma_m : options.mount_sigma_m);
    sigma.segment<3>(model.mount_column(i) + 3)
        .setConstant(turns ? options.mount_sigma_rad : RegistrationWeights::kFixed);
  }
  hold_first_roll(model, sigma);
  return weights;
}

bool whiten(RegistrationModel& model, const RegistrationWeights& weights, const RegistrationState& from,
            const Eigen::VectorXd& x, WhitenedRegistration& at) {
  RegistrationModel::Evaluation raw;
  if (!model.evaluate(from, x, raw)) return false;
  const int rows = model.rows(), unknowns = model.unknowns();
  const auto W = weights.noise_factor.triangularView<Eigen::Lower>();
  at.residual.resize(rows + unknowns);
  at.jacobian.resize(rows + unknowns, unknowns);
  at.residual.head(rows) = W.solve(raw.residual);
  at.jacobian.topRows(rows) = -W.solve(raw.jacobian);
  at.residual.tail(unknowns) = x.cwiseQuotient(weights.prior_sigma);
  at.jacobian.bottomRows(unknowns) = weights.prior_sigma.cwiseInverse().asDiagonal();
  return true;
}

RegistrationFit fit_registration(RegistrationModel& model, const RegistrationWeights& weights,
                                 const RegistrationState& start, int most_iterations) {
  RegistrationState from = model.stated();
  from.T_reference_base = start.T_reference_base;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(model.unknowns());
  x(RegistrationModel::kTwistColumn) = start.twist_change_per_m;
  for (int j = 0; j < model.positions(); ++j)
    x.segment<2>(RegistrationModel::bend_column(j)) = start.bend_change_per_m[static_cast<std::size_t>(j)];

  RegistrationFit fit;
  WhitenedRegistration at;
  if (!whiten(model, weights, from, x, at)) return fit;  // Ceres would say so on the screen
  ceres::Problem::Options owned;
  owned.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(owned);
  RegistrationCost cost(model, weights, from);
  problem.AddResidualBlock(&cost, nullptr, x.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = most_iterations;
  options.function_tolerance = 1e-12;
  options.parameter_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  fit.iterations = static_cast<int>(summary.iterations.size());
  if (!summary.IsSolutionUsable()) return fit;
  fit.converged = summary.termination_type == ceres::CONVERGENCE;
  fit.chi_square = 2.0 * summary.final_cost;
  fit.state = model.step(from, x);
  fit.x = x;
  fit.x.head<6>().setZero();
  return fit;
}

}  // namespace palpate
