// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/stiffness_steps.hpp>

namespace palpate::stiffness {

/// A fit with all that a report or a prediction is made of.
struct Fitted {
  Problem problem;
  Eigen::VectorXd z{};
  Eigen::MatrixXd covariance{};  ///< of z
  Minimum minimum{};
  std::vector<std::string> warnings{};
  double chi_square = 0.0;
  int degrees_of_freedom = 0;
};

/// `cases` must outlive the result.
Fitted fit(const Catheter& catheter, std::span<const LoadCase> cases, const StiffnessOptions& options);

std::vector<StiffnessUnknown> unknowns_of(const Fitted& fitted);

}  // namespace palpate::stiffness
