// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <palpate/evaluation/force_size.hpp>

namespace palpate {

bool is_measured(EstimateStatus status) {
  return status == EstimateStatus::kUpdated || status == EstimateStatus::kReseeded;
}

double sigma_of_norm(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> principal(covariance, Eigen::EigenvaluesOnly);
  const double most = std::max(0.0, principal.eigenvalues().maxCoeff());
  const double size = mean.norm();
  if (!(size > 0.0)) return std::sqrt(most);
  const Eigen::VectorXd u = mean / size;
  const Eigen::MatrixXd QP = covariance - u * (u.transpose() * covariance);
  const double variance = u.dot(covariance * u) + 0.5 * (QP * QP).trace() / (size * size);
  return std::sqrt(std::clamp(variance, 0.0, most));
}

std::vector<ForceSize> force_sizes(std::span<const EstimateRow> rows) {
  std::vector<ForceSize> sizes;
  sizes.reserve(rows.size());
  for (const EstimateRow& row : rows)
    sizes.push_back({row.time_s, row.force_tip_N.norm(), sigma_of_norm(row.force_tip_N, row.covariance_tip_N2),
                     is_measured(row.status)});
  return sizes;
}

}  // namespace palpate
