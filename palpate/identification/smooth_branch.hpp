// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate {

/// A smooth curve through scattered values, as values at knots.
struct SmoothBranch {
  Eigen::VectorXd value;              ///< at the knots
  Eigen::VectorXd variance;           ///< of these, for values of variance 1
  double rss = 0.0;                   ///< sum of squared residuals
  double effective_parameters = 0.0;  ///< trace of the smoother
};

/// Cubic curve through values v at the knots (equal steps, two or more), slopes by parabolas through three of them, so
/// that it is B v at the samples. Minimises |y - B v|^2 + lambda |second differences of v|^2; lambda makes
/// n |y - B v|^2 / (n - trace)^2 least (generalised cross-validation). Variance: Wahba 1983, (B^T B + lambda D^T D)^-1,
/// which has room for the bias of smoothing.
SmoothBranch smooth_branch(const std::vector<double>& x, const std::vector<double>& y,
                           const std::vector<double>& knots);

}  // namespace palpate
