// SPDX-License-Identifier: Apache-2.0
#include <Eigen/QR>
#include <limits>
#include <palpate/estimation/unscented.hpp>

namespace palpate::detail {

namespace {

/// Cholesky factor of a covariance, or false; LLT alone lets NaN pass.
template <class Matrix>
bool factor_covariance(const Matrix& covariance, Eigen::LLT<Matrix>& factor) {
  factor.compute(covariance);
  return factor.info() == Eigen::Success && factor.matrixLLT().allFinite();
}

/// F F^T. Rounding moves its elements by up to n eps sqrt(P_ii P_jj), which is all there is to a combination of states
/// that a measurement has pinned down; the diagonal is raised by as much as that and the next factorisation can lose.
StateMatrix square(const StateMatrix& F) {
  const auto n = static_cast<double>(F.rows());
  const StateMatrix P = F.lazyProduct(F.transpose());
  // the compiler may contract packets and single elements differently: symmetric by construction
  StateMatrix symmetric = 0.5 * (P + P.transpose());
  symmetric.diagonal() *= 1.0 + 2.0 * (n + 1.0) * (n + 1.0) * std::numeric_limits<double>::epsilon();
  return symmetric;
}

}  // namespace

void solve_whitened(const Regression& line, WhitenedPosterior& out) {
  constexpr int kMaxRows = kMaxResiduals + 2 * kMaxStates, kMaxUnknowns = 2 * kMaxStates;
  using Array = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxRows, kMaxUnknowns>;
  const Eigen::Index m = line.nu.size(), n = line.G.cols();
  Array A = Array::Zero(m + 2 * n, 2 * n);
  A.topLeftCorner(m, n) = line.E;
  A.topRightCorner(m, n) = line.G;
  A.bottomRows(2 * n).diagonal().setOnes();
  Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxRows, 1> q;
  q.setZero(m + 2 * n);
  q.head(m) = line.nu;

  const Eigen::HouseholderQR<Array> qr(A);  // in one block of 32 columns: a second one would allocate
  static_assert(kMaxUnknowns <= 32);
  q.applyOnTheLeft(qr.householderQ().adjoint());
  const StateMatrix R_zz = qr.matrixQR().block(n, n, n, n);
  out.mean = q.segment(n, n);
  R_zz.triangularView<Eigen::Upper>().solveInPlace(out.mean);
  out.T.setIdentity(n, n);
  R_zz.triangularView<Eigen::Upper>().solveInPlace(out.T);
  const StateMatrix upper = R_zz.triangularView<Eigen::Upper>();
  out.information = upper.transpose().lazyProduct(upper);
  out.chi_square = q.tail(m).squaredNorm();
}

SigmaPoints::SigmaPoints(const ResidualMatrix& noise, const Gaussian& prior) : prior_(prior) {
  definite_ = factor_covariance(noise, W_) && factor_covariance(prior.covariance, L_factor_);
  if (definite_) L_ = L_factor_.matrixL();
}

bool SigmaPoints::conclude(Regression& line, int nuisance_states, Update& out) {
  out.innovation = line.nu;
  out.line.x0 = prior_.mean;
  out.line.at_x0.residual = line.nu;
  out.line.at_x0.jacobian = L_factor_.matrixL().transpose().solve(line.G.transpose()).transpose();  // G = J L
  out.line.more_noise = line.E.lazyProduct(line.E.transpose());

  W_.matrixL().solveInPlace(line.nu);
  W_.matrixL().solveInPlace(line.G);
  W_.matrixL().solveInPlace(line.E);
  solve_whitened(line, z_);
  const Gaussian posterior{prior_.mean + L_.lazyProduct(z_.mean), square(L_.lazyProduct(z_.T))};
  Eigen::LLT<StateMatrix> factor;
  if (!posterior.mean.allFinite() || !factor_covariance(posterior.covariance, factor)) return false;
  out.posterior = posterior;
  out.chi_square = z_.chi_square;
  out.surprise = whitened_surprise(z_.mean, z_.information, nuisance_states);
  return true;
}

double SigmaPoints::residual_chi_square(const ResidualVector& residual, int nuisance_states) const {
  const ResidualVector whitened = W_.matrixL().solve(residual);
  return whitened.squaredNorm() + z_.mean.tail(nuisance_states).squaredNorm();
}

}  // namespace palpate::detail
