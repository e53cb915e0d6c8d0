// SPDX-License-Identifier: Apache-2.0
#include <ceres/ceres.h>

#include <palpate/identification/minimisers.hpp>

namespace palpate::stiffness {

namespace {

class Cost final : public ceres::CostFunction {
 public:
  Cost(const Residuals& residuals, int rows, int unknowns) : residuals_(residuals) {
    set_num_residuals(rows);
    mutable_parameter_block_sizes()->push_back(unknowns);
  }

  bool Evaluate(double const* const* parameters, double* residual, double** jacobians) const override {
    const int n = parameter_block_sizes().front();
    Eigen::VectorXd r;
    Eigen::MatrixXd by_z;
    if (!residuals_(Eigen::Map<const Eigen::VectorXd>(parameters[0], n), r, by_z)) return false;
    Eigen::Map<Eigen::VectorXd>(residual, r.size()) = r;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    using OneColumn = Eigen::Matrix<double, Eigen::Dynamic, 1>;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    if (n == 1)
      Eigen::Map<OneColumn>(jacobians[0], r.size()) = by_z;
    else
      Eigen::Map<RowMajor>(jacobians[0], r.size(), n) = by_z;
    return true;
  }

 private:
  const Residuals& residuals_;
};

}  // namespace

Minimum levenberg_marquardt(const Residuals& residuals, int rows, Eigen::VectorXd& z) {
  const int n = static_cast<int>(z.size());
  Eigen::VectorXd r;
  Eigen::MatrixXd by_z;
  if (!residuals(z, r, by_z)) return {};  // Ceres would say so on stderr
  Cost cost(residuals, rows, n);
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  problem.AddResidualBlock(&cost, nullptr, z.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.max_num_iterations = 100;
  options.initial_trust_region_radius = 1e6;  // the start is near: nearly Gauss and Newton's own step
  options.max_num_consecutive_invalid_steps = 30;
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-9;
  options.gradient_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return {.converged = summary.termination_type == ceres::CONVERGENCE,
          .iterations = static_cast<int>(summary.iterations.size())};
}

}  // namespace palpate::stiffness
