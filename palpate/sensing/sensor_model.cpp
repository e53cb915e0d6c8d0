// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <palpate/sensing/sensor_model.hpp>

namespace palpate {

int rows_of(SensorKind kind) {
  switch (kind) {
    case SensorKind::kPose:
      return 6;
    case SensorKind::kPose5:
      return 5;
    case SensorKind::kPosition:
      return 3;
  }
  return 0;
}

namespace {

/// e = R_predicted^T d_measured, r = f(e_z) (-e_y, e_x), f(c) = acos(c) / sin(acos(c)); de = -phi x e = hat(e) phi.
OrientationResidual axis_residual(const Vector3d& e) {
  const double c = std::clamp(e.z(), -1.0, 1.0);
  const double s2 = 1.0 - c * c;
  const bool near_zero = s2 < 1e-8 && c > 0.0;
  const double f = near_zero ? 1.0 + (1.0 - c) / 3.0 : std::acos(c) / std::sqrt(std::max(s2, 1e-16));
  const double df = near_zero ? -1.0 / 3.0 : (c * f - 1.0) / std::max(s2, 1e-16);
  Eigen::Matrix<double, 2, 3> by_e;
  by_e << 0.0, -f, -e.y() * df, f, 0.0, e.x() * df;
  OrientationResidual r;
  r.value = Eigen::Vector2d(-e.y(), e.x()) * f;
  r.D = -by_e * hat(e);
  return r;
}

}  // namespace

OrientationResidual orientation_residual(SensorKind kind, const Matrix3d& R_predicted, const Matrix3d& R_measured) {
  const Matrix3d R_error = R_predicted.transpose() * R_measured;
  if (kind == SensorKind::kPose5) return axis_residual(R_error.col(2));
  OrientationResidual r;
  const Vector3d value = log_so3(R_error);
  r.value = value;
  r.D = inverse_left_jacobian(value);
  return r;
}

}  // namespace palpate
