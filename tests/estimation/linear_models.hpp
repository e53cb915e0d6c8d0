// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <palpate/estimation/kalman.hpp>
#include <tests/random_draws.hpp>

/// Models whose best estimate is known by other means.
namespace palpate::test {

/// y = H x + w, w ~ N(0, R).
struct LinearModel {
  Eigen::MatrixXd H, R;
  Eigen::VectorXd y;

  int rows() const { return static_cast<int>(y.size()); }
  void noise(ResidualMatrix& out) const { out = R; }
  bool linearize(const StateVector& x, Linearization& at) {
    at.residual = y - H * x;
    at.jacobian = H;
    return true;
  }
};

inline Eigen::MatrixXd random_matrix(int rows, int cols, Draws& draws) {
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&](Eigen::Index, Eigen::Index) { return draws.normal(); });
}

inline Eigen::MatrixXd random_covariance(int n, Draws& draws) {
  const Eigen::MatrixXd A = random_matrix(n, n, draws);
  return A * A.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
}

inline LinearModel random_linear_model(int states, int rows, Draws& draws) {
  return {random_matrix(rows, states, draws), random_covariance(rows, draws), random_matrix(rows, 1, draws)};
}

inline Gaussian random_prior(int states, Draws& draws) {
  return {random_matrix(states, 1, draws), random_covariance(states, draws)};
}

/// The textbook: nu = y - H x, S = H P H^T + R, K = P H^T S^-1, x + K nu, P - K S K^T, chi-square nu^T S^-1 nu.
struct Textbook {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  double nis;
};

inline Textbook textbook_update(const LinearModel& model, const Gaussian& prior) {
  const Eigen::MatrixXd P = prior.covariance;
  const Eigen::VectorXd nu = model.y - model.H * prior.mean;
  const Eigen::MatrixXd S = model.H * P * model.H.transpose() + model.R;
  const Eigen::MatrixXd K = P * model.H.transpose() * S.inverse();
  return {prior.mean + K * nu, P - K * S * K.transpose(), nu.dot(S.inverse() * nu)};
}

}  // namespace palpate::test
