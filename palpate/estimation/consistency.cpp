// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <boost/math/distributions/chi_squared.hpp>
#include <limits>
#include <palpate/estimation/consistency.hpp>

namespace palpate {

double chi_square_tail_quantile(double tail, int degrees) {
  const boost::math::chi_squared distribution(degrees);
  return boost::math::quantile(boost::math::complement(distribution, tail));
}

double normalised_error_squared(const StateVector& error, const StateMatrix& covariance) {
  const Eigen::LLT<StateMatrix> factor(covariance);
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  return error.dot(factor.solve(error));
}

ChiSquareGate::ChiSquareGate(double tail) {
  for (int degrees = 1; degrees <= kMaxResiduals; ++degrees)
    threshold_[static_cast<std::size_t>(degrees)] = chi_square_tail_quantile(tail, degrees);
}

ConvergenceIndex convergence_index(const ResidualVector& residual, const JacobianMatrix& jacobian,
                                   const StateMatrix& prior_covariance, const ResidualMatrix& noise) {
  const ResidualMatrix S = jacobian * prior_covariance * jacobian.transpose() + noise;
  const Eigen::LLT<ResidualMatrix> factor(S);
  if (factor.info() != Eigen::Success) return {};
  return {residual.dot(S * residual), residual.dot(factor.solve(residual))};
}

}  // namespace palpate
