// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>

/// The two minimisers, behind functions, so that each library is included once.
namespace palpate::stiffness {

/// Residuals r(z) and their derivative; false where they do not exist.
using Residuals = std::function<bool(const Eigen::VectorXd& z, Eigen::VectorXd& r, Eigen::MatrixXd& by_z)>;

struct Minimum {
  bool converged = false;
  int iterations = 0;
};

/// Ceres: z becomes the minimum of |r|^2 / 2 near z; left alone where r(z) does not exist. `rows`: of r.
Minimum levenberg_marquardt(const Residuals& residuals, int rows, Eigen::VectorXd& z);

/// NLopt: z becomes the minimum of `cost` near z; infinite where it does not exist. `step`: of the first simplex.
Minimum nelder_mead(const std::function<double(const Eigen::VectorXd& z)>& cost, double step, Eigen::VectorXd& z);

}  // namespace palpate::stiffness
