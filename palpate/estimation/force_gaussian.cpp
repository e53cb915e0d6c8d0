// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <palpate/estimation/force_gaussian.hpp>

namespace palpate {

ForceLikelihood likelihood_between(const ForceGaussian& prior, const ForceGaussian& posterior) {
  // Whitened by the prior, P- = L L^T: L^-1 P+ L^-T = V diag(d) V^T, whose information is diag(1/d - 1) >= 0.
  const Eigen::LLT<Matrix3d> factor(prior.covariance_N2);
  if (factor.info() != Eigen::Success) return {};
  const Matrix3d half = factor.matrixL().solve(posterior.covariance_N2);
  const Matrix3d whitened = factor.matrixL().solve(half.transpose());
  Eigen::SelfAdjointEigenSolver<Matrix3d> spectrum;
  spectrum.computeDirect(0.5 * (whitened + whitened.transpose()));
  if (!(spectrum.eigenvalues().minCoeff() > 0.0)) return {};

  const Vector3d information = (spectrum.eigenvalues().cwiseInverse().array() - 1.0).cwiseMax(0.0);
  const Vector3d shift = spectrum.eigenvectors().transpose() * factor.matrixL().solve(posterior.mean_N - prior.mean_N);
  const Matrix3d to_N = factor.matrixU().solve(spectrum.eigenvectors());  // L^-T V
  ForceLikelihood out;
  out.information_per_N2 = to_N * information.asDiagonal() * to_N.transpose();
  // A direction without information keeps none: its share of the shift is rounding.
  const Vector3d pull = (information.array() > 0.0).select((information.array() + 1.0) * shift.array(), 0.0);
  out.information_mean_per_N = out.information_per_N2 * prior.mean_N + to_N * pull;
  return out;
}

ForceGaussian posterior_of(const ForceGaussian& prior, const ForceLikelihood& likelihood) {
  const Eigen::LLT<Matrix3d> factor(prior.covariance_N2);
  if (factor.info() != Eigen::Success) return prior;
  const Matrix3d L = factor.matrixL();
  const Matrix3d G = Matrix3d::Identity() + L.transpose() * likelihood.information_per_N2 * L;
  const Eigen::LLT<Matrix3d> inner(G);
  if (inner.info() != Eigen::Success) return prior;
  const Matrix3d W = inner.matrixL().solve(L.transpose());  // P+ = W^T W
  ForceGaussian out;
  out.covariance_N2 = W.transpose() * W;
  out.mean_N = prior.mean_N +
               out.covariance_N2 * (likelihood.information_mean_per_N - likelihood.information_per_N2 * prior.mean_N);
  return out;
}

ForceGaussian within_belief(const ForceGaussian& force, double limit_N) {
  ForceGaussian out = force;
  const double limit = limit_N * limit_N;
  for (int i = 0; i < 3; ++i) {
    const double variance = out.covariance_N2(i, i);
    if (!(variance > limit)) continue;
    const Vector3d column = out.covariance_N2.col(i) / variance;
    out.mean_N -= column * (out.mean_N(i) * (1.0 - limit / variance));
    out.covariance_N2 -= column * column.transpose() * (variance - limit);
  }
  return out;
}

}  // namespace palpate
