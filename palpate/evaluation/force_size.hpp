// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/estimate_csv.hpp>
#include <span>
#include <vector>

namespace palpate {

/// How large a force is, for figures over time: one entry a frame.
struct ForceSize {
  double time_s = 0.0;
  double size_N = 0.0;
  double sigma_N = 0.0;
  bool measured = false;  ///< UPDATED or RESEEDED: a predicted or ambiguous force is counted by no figure
};

/// UPDATED or RESEEDED.
bool is_measured(EstimateStatus status);

/// Sigma of |x|, x ~ N(mean, P), to second order: u^T P u + tr((Q P)^2) / (2 |x|^2) with u = x / |x|, Q = I - u u^T;
/// at most the largest principal sigma, which is what remains at |x| = 0.
double sigma_of_norm(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance);

/// |F| of every row.
std::vector<ForceSize> force_sizes(std::span<const EstimateRow> rows);

}  // namespace palpate
