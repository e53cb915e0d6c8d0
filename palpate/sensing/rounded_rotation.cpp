// SPDX-License-Identifier: Apache-2.0
#include <Eigen/SVD>
#include <cmath>
#include <palpate/sensing/rounded_rotation.hpp>

namespace palpate {

Eigen::Vector4d nearest_quaternion(const Matrix3d& R) {
  constexpr double kTolerance = 0.01;
  if (!R.allFinite() || std::abs(R.determinant() - 1.0) > kTolerance) return Eigen::Vector4d::Zero();
  if ((R.transpose() * R - Matrix3d::Identity()).cwiseAbs().maxCoeff() > 2.0 * kTolerance)
    return Eigen::Vector4d::Zero();
  if (R.isIdentity(0.0)) return {1.0, 0.0, 0.0, 0.0};
  const Eigen::JacobiSVD<Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Quaterniond q(Matrix3d(svd.matrixU() * svd.matrixV().transpose()));
  return {q.w(), q.x(), q.y(), q.z()};
}

}  // namespace palpate
