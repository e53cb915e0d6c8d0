// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <palpate/math/linearization.hpp>

/// Is the claimed covariance true? Chi-square statistics of errors and innovations.
namespace palpate {

/// x with P(chi-square of `degrees` > x) = `tail`. degrees >= 1, 0 < tail < 1.
double chi_square_tail_quantile(double tail, int degrees);

/// Normalised estimation error squared: e^T P^-1 e; its mean over a consistent filter's run is the dimension.
/// NaN where P is not positive definite.
double normalised_error_squared(const StateVector& error, const StateMatrix& covariance);

/// The same threshold for every number of degrees of freedom, looked up without cost in the real-time step.
class ChiSquareGate {
 public:
  /// `tail`: share of good measurements that the gate refuses.
  explicit ChiSquareGate(double tail);
  double threshold(int degrees) const { return threshold_[static_cast<std::size_t>(degrees)]; }
  bool passes(double chi_square, int degrees) const { return degrees <= 0 || chi_square <= threshold(degrees); }

 private:
  std::array<double, kMaxResiduals + 1> threshold_{};
};

/// The paper's convergence index, section 4.2: rho = r^T S r, which mixes units, and r^T S^-1 r, which does not.
struct ConvergenceIndex {
  double paper = 0.0;
  double normalised = 0.0;
};

/// r: post-fit residual; S = J P J^T + R, with P the covariance before the update.
ConvergenceIndex convergence_index(const ResidualVector& residual, const JacobianMatrix& jacobian,
                                   const StateMatrix& prior_covariance, const ResidualMatrix& noise);

}  // namespace palpate
