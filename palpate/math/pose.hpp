// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/math/rotation.hpp>

namespace palpate {

/// Rigid motion T_a_b: p_a = R p_b + p. Names read T_a_b with R_a_b and p_a_b; adjacent frames cancel.
struct Pose {
  Matrix3d R = Matrix3d::Identity();
  Vector3d p = Vector3d::Zero();

  Pose inverse() const { return {R.transpose(), -(R.transpose() * p)}; }
  Vector3d operator*(const Vector3d& point) const { return R * point + p; }
  Pose operator*(const Pose& other) const { return {R * other.R, R * other.p + p}; }
};

}  // namespace palpate
