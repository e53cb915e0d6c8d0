// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

/// SO(3) with its tangent maps. Tangents are body-side (right): R exp(phi) ~ R (I + hat(phi)).
namespace palpate {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// hat(a) b = a x b.
inline Matrix3d hat(const Vector3d& a) {
  Matrix3d A;
  A << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return A;
}

/// exp: R^3 [rad] -> SO(3), Rodrigues' formula.
inline Matrix3d exp_so3(const Vector3d& phi) {
  const double angle = phi.norm();
  if (angle < 1e-10) return Matrix3d::Identity() + hat(phi);
  return Eigen::AngleAxisd(angle, phi / angle).toRotationMatrix();
}

/// log: SO(3) -> R^3 [rad], |log| <= pi. Through the quaternion, so it stays exact near 0 and near pi.
inline Vector3d log_so3(const Matrix3d& R) {
  Eigen::Quaterniond q(R);
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double s2 = q.vec().squaredNorm();
  if (s2 < 2.5e-3) {  // asin(s) / s, to the last bit
    const double ratio =
        1.0 + s2 * (1.0 / 6 + s2 * (3.0 / 40 + s2 * (5.0 / 112 + s2 * (35.0 / 1152 + s2 * (63.0 / 2816)))));
    return (2.0 * ratio) * q.vec();
  }
  const double sine = std::sqrt(s2);
  return (2.0 * std::atan2(sine, q.w()) / sine) * q.vec();
}

/// Right Jacobian: exp(phi + eps) = exp(phi) exp(J_r(phi) eps) + O(eps^2).
/// J_r = I - (1 - cos a)/a^2 hat(phi) + (a - sin a)/a^3 hat(phi)^2, a = |phi|.
inline Matrix3d right_jacobian(const Vector3d& phi) {
  const double a = phi.norm();
  const Matrix3d H = hat(phi);
  const bool small = a < 1e-3;
  const double half_sine = std::sin(0.5 * a);
  const double b = small ? 0.5 - a * a / 24.0 : 2.0 * half_sine * half_sine / (a * a);
  const double c = small ? 1.0 / 6.0 - a * a / 120.0 : (a - std::sin(a)) / (a * a * a);
  return Matrix3d::Identity() - b * H + c * H * H;
}

/// Inverse of the left Jacobian: log(exp(eps) exp(phi)) = phi + J_l^-1(phi) eps + O(eps^2).
/// J_l^-1 = I - hat(phi)/2 + (1/a^2 - cot(a/2)/(2a)) hat(phi)^2, a = |phi| < 2 pi.
inline Matrix3d inverse_left_jacobian(const Vector3d& phi) {
  const double a2 = phi.squaredNorm();
  double c = 1.0 / 12 + a2 * (1.0 / 720 + a2 * (1.0 / 30240 + a2 * (1.0 / 1209600 + a2 / 47900160)));
  if (a2 > 0.06) {  // below, the closed form cancels
    const double angle = std::sqrt(a2);
    c = 1.0 / a2 - 0.5 / (angle * std::tan(0.5 * angle));
  }
  Matrix3d J = c * phi * phi.transpose() - 0.5 * hat(phi);
  J.diagonal().array() += 1.0 - c * a2;
  return J;
}

/// Inverse of the right Jacobian: log(exp(phi) exp(eps)) = phi + J_r^-1(phi) eps + O(eps^2).
inline Matrix3d inverse_right_jacobian(const Vector3d& phi) { return inverse_left_jacobian(-phi); }

}  // namespace palpate
