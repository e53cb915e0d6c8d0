// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>
#include <palpate/math/pose.hpp>
#include <random>

namespace palpate {
namespace {

Vector3d random_vector(std::mt19937_64& random, double scale) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  return scale * Vector3d(unit(random), unit(random), unit(random));
}

/// exp by its power series, in long double: independent of Rodrigues' formula.
Matrix3d exp_series(const Vector3d& phi) {
  using Mat = Eigen::Matrix<long double, 3, 3>;
  const Mat H = hat(phi).cast<long double>();
  Mat sum = Mat::Identity(), term = Mat::Identity();
  for (int k = 1; k < 60; ++k) sum += term = term * H / k;
  return sum.cast<double>();
}

TEST(Rotation, HatIsTheCrossProduct) {
  const Vector3d a(1, 2, 3), b(-4, 5, 7);
  EXPECT_LT((hat(a) * b - a.cross(b)).norm(), 1e-15);
}

TEST(Rotation, ExpAgreesWithItsPowerSeriesAtEveryScale) {
  std::mt19937_64 random(1);
  for (const double scale : {1e-14, 1e-11, 1e-9, 1e-6, 1e-3, 1.0, 3.0})
    for (int i = 0; i < 50; ++i) {
      const Vector3d phi = random_vector(random, scale);
      EXPECT_LT((exp_so3(phi) - exp_series(phi)).norm(), 1e-14) << phi.transpose();
    }
}

TEST(Rotation, LogInvertsExpNearZeroAndNearHalfATurn) {
  std::mt19937_64 random(2);
  for (const double angle :
       {1e-14, 1e-11, 1e-9, 1e-5, 0.0999, 0.1001, 0.1, 1.0, 3.0, std::numbers::pi - 1e-6, std::numbers::pi - 1e-9})
    for (int i = 0; i < 50; ++i) {
      const Vector3d phi = angle * random_vector(random, 1.0).normalized();
      EXPECT_LT((log_so3(exp_so3(phi)) - phi).norm(), 1e-15 + 1e-14 * angle) << phi.transpose();
    }
}

TEST(Rotation, InverseJacobiansAreDerivativesOfLog) {
  std::mt19937_64 random(3);
  constexpr double h = 1e-5;
  for (const double angle : {0.0, 1e-6, 1e-3, 0.5, 2.0, 3.0}) {
    const Vector3d phi = angle * random_vector(random, 1.0).normalized();
    for (int k = 0; k < 3; ++k) {
      const Vector3d step = h * Vector3d::Unit(k);
      const Vector3d left = (log_so3(exp_so3(step) * exp_so3(phi)) - log_so3(exp_so3(-step) * exp_so3(phi))) / (2 * h);
      const Vector3d right = (log_so3(exp_so3(phi) * exp_so3(step)) - log_so3(exp_so3(phi) * exp_so3(-step))) / (2 * h);
      EXPECT_LT((left - inverse_left_jacobian(phi).col(k)).norm(), 1e-8) << angle;
      EXPECT_LT((right - inverse_right_jacobian(phi).col(k)).norm(), 1e-8) << angle;
    }
  }
}

/// J_l^-1 phi = phi, and with J_l = I + b hat(phi) + c hat(phi)^2 by its power series, in long double: both sides of
/// the angle (0.245 rad) where a series takes over.
TEST(Rotation, InverseLeftJacobianInvertsTheSeries) {
  using Mat = Eigen::Matrix<long double, 3, 3>;
  std::mt19937_64 random(4);
  for (const double angle : {1e-9, 1e-4, 0.1, 0.2449, 0.245, 0.2451, 0.5, 3.0}) {
    const Vector3d phi = angle * random_vector(random, 1.0).normalized();
    const Mat H = hat(phi).cast<long double>();
    Mat J = Mat::Identity(), term = Mat::Identity();
    for (int k = 1; k < 60; ++k) J += term = term * H / (k + 1);
    const Mat product = J * inverse_left_jacobian(phi).cast<long double>();
    EXPECT_LT(static_cast<double>((product - Mat::Identity()).norm()), 2e-15) << angle;
  }
}

/// Rounding of the differences is 1e-16 / h = 1e-11, their truncation h^2 / 6.
TEST(Rotation, RightJacobianIsTheDerivativeOfExp) {
  std::mt19937_64 random(5);
  constexpr double h = 1e-5;
  for (const double angle : {0.0, 1e-9, 1e-4, 0.9e-3, 1.1e-3, 0.5, 2.0, 3.0, 6.0, 10.0}) {
    const Vector3d phi = angle * random_vector(random, 1.0).normalized();
    for (int k = 0; k < 3; ++k) {
      const Vector3d step = h * Vector3d::Unit(k);
      const Matrix3d back = exp_series(phi).transpose();
      const Vector3d turn = (log_so3(back * exp_series(phi + step)) - log_so3(back * exp_series(phi - step))) / (2 * h);
      EXPECT_LT((turn - right_jacobian(phi).col(k)).norm(), 1e-9) << angle;
    }
  }
}

/// Both sides of the angle where the series takes over (1e-3 rad): cancellation in 1 - cos leaves 1e-16 / 1e-3 there.
TEST(Rotation, RightJacobianAndItsInverseUndoEachOther) {
  std::mt19937_64 random(6);
  for (const double angle : {0.0, 1e-12, 1e-6, 0.9e-4, 1.1e-4, 0.99e-3, 1.01e-3, 0.1, 1.0, 3.0, 5.5})
    for (int i = 0; i < 20; ++i) {
      const Vector3d phi = angle * random_vector(random, 1.0).normalized();
      EXPECT_LT((right_jacobian(phi) * inverse_right_jacobian(phi) - Matrix3d::Identity()).norm(), 2e-12) << angle;
    }
}

TEST(Pose, ComposesAndInverts) {
  std::mt19937_64 random(4);
  const Pose T_a_b{exp_so3(random_vector(random, 2.0)), random_vector(random, 1.0)};
  const Pose T_b_c{exp_so3(random_vector(random, 2.0)), random_vector(random, 1.0)};
  const Vector3d p_c = random_vector(random, 1.0);
  EXPECT_LT(((T_a_b * T_b_c) * p_c - T_a_b * (T_b_c * p_c)).norm(), 1e-15);
  EXPECT_LT((T_a_b.inverse() * (T_a_b * p_c) - p_c).norm(), 1e-15);
}

}  // namespace
}  // namespace palpate
