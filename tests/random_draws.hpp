// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <palpate/math/pose.hpp>
#include <random>

namespace palpate::test {

/// Seeded draws for property tests.
class Draws {
 public:
  explicit Draws(unsigned seed) : engine_(seed) {}

  double normal() { return normal_(engine_); }
  double uniform(double from, double to) { return from + (to - from) * unit_(engine_); }
  Vector3d normal3() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }
  Vector3d in_ball(double radius) { return radius * std::cbrt(uniform(0.0, 1.0)) * normal3().normalized(); }
  /// Turn by a normal rotation vector; through Eigen, not through exp_so3, which is itself under test.
  Matrix3d small_turn(double sigma_rad) { return turn(sigma_rad * normal3()); }
  Matrix3d rotation() {
    const Eigen::Vector4d q(normal(), normal(), normal(), normal());
    return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
  }
  Pose pose(double radius_m) { return {rotation(), in_ball(radius_m)}; }

  static Matrix3d turn(const Vector3d& vector_rad) {
    const double angle = vector_rad.norm();
    if (angle == 0.0) return Matrix3d::Identity();
    return Eigen::AngleAxisd(angle, vector_rad / angle).toRotationMatrix();
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> unit_;
};

}  // namespace palpate::test
