// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>
#include <palpate/estimation/frame_line.hpp>
#include <palpate/estimation/whitened.hpp>

namespace palpate {

/// [W^-1 J, W^-1 r] = Q [R_1 r_1; 0 r_2].
void compress(FrameLine& line) {
  const Eigen::Index m = line.residual.size();
  if (line.by_parameters.cols() > 0 || m <= 3) return;
  const NoiseFactor noise(line.noise);
  if (!noise.definite()) return;
  FrameLine::Rows<4> rows(m, 4);
  rows << line.by_force, line.residual;
  noise.whiten_rows(rows);
  const Eigen::HouseholderQR<FrameLine::Rows<4>> qr(rows);
  const Eigen::Matrix<double, 3, 4> R = qr.matrixQR().topRows<3>().triangularView<Eigen::Upper>();
  line.by_force = R.leftCols<3>();
  line.residual = R.col(3);
  line.by_parameters.resize(3, 0);
  line.noise.setIdentity(3, 3);
}

bool hide_axial_force(double weak_N, bool hidden_before, const Eigen::MatrixXd& parameter_covariance, FrameLine& line) {
  constexpr double kSeenAgain = 0.6;
  line.hidden.setZero();
  line.hiding_rows = line.residual.size();
  ResidualMatrix R = line.noise;
  if (line.by_parameters.cols() > 0) {
    const FrameLine::Rows<Eigen::Dynamic, kMaxParameters> JP = line.by_parameters.lazyProduct(parameter_covariance);
    R += JP.lazyProduct(line.by_parameters.transpose());
  }
  const Eigen::LLT<ResidualMatrix> factor(R);
  if (factor.info() != Eigen::Success) return false;
  FrameLine::Rows<3> J = line.by_force;
  factor.matrixL().solveInPlace(J);
  const Eigen::SelfAdjointEigenSolver<Matrix3d> spectrum(Matrix3d(J.transpose() * J));
  const Vector3d weakest = spectrum.eigenvectors().col(0);
  const bool axial = weakest.z() * weakest.z() > 0.5;
  const double blind_N = hidden_before ? kSeenAgain * weak_N : weak_N;
  const bool hidden = axial && spectrum.eigenvalues()(0) * blind_N * blind_N < 1.0;
  if (hidden) line.hidden = weakest * weakest.transpose();
  return hidden;
}

FrameLine line_of(const ForceLikelihood& likelihood, Eigen::Index parameters) {
  FrameLine line;
  Eigen::SelfAdjointEigenSolver<Matrix3d> spectrum;
  spectrum.compute(likelihood.information_per_N2);
  line.residual.resize(3);
  line.by_force.resize(3, 3);
  for (int i = 0; i < 3; ++i) {
    const double information = spectrum.eigenvalues()(i);
    const Vector3d axis = spectrum.eigenvectors().col(i);
    const double root = information > 0.0 ? std::sqrt(information) : 0.0;
    line.by_force.row(i) = root * axis.transpose();
    line.residual(i) = root > 0.0 ? axis.dot(likelihood.information_mean_per_N) / root : 0.0;
  }
  if (!likelihood.information_mean_per_N.allFinite()) line.residual = likelihood.information_mean_per_N;
  line.by_parameters.setZero(3, parameters);
  line.parameters.setZero(parameters);
  line.noise.setIdentity(3, 3);
  return line;
}

}  // namespace palpate
