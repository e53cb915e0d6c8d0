// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <palpate/math/pose.hpp>

/// The yardstick: the paper's estimator as one writes it from the textbook, and as quick as that can be made. Classical
/// Runge-Kutta in exactly 20 steps on the quaternion, central differences, ten undamped iterations; sizes fixed,
/// nothing allocated. Shares with palpate the pose type and the logarithm, no more.
///
/// Where the textbook leaves a choice, the quicker one is taken: the curvature from the first integral of (5), (6), a
/// state of 7 numbers instead of 13; the quaternion normalised where it is read, not after each step; the update (17)
/// in information form, a 3 x 3 system instead of the gain's.
namespace palpate::textbook {

/// One section, no tip load but the force; two sensors with the local frames' axes: at the tip and at `behind_m`.
struct Shaft {
  double length_m = 0.0;
  double behind_m = 0.0;  ///< arc length of the second sensor, in (0, length)
  Vector3d stiffness_Nm2 = Vector3d::Ones();
  Vector3d precurvature_per_m = Vector3d::Zero();
};

/// T_base_local at the two sensors.
struct SensorPoses {
  Pose tip, behind;
};

/// Quaternion (w, a) and position: tip axes, from the tip. Plain numbers, which the compiler keeps in registers; an
/// Eigen vector of them takes 1.7 times the time, for what is written one by one is then read in packets.
struct RodState {
  double w = 1.0, a1 = 0.0, a2 = 0.0, a3 = 0.0, r1 = 0.0, r2 = 0.0, r3 = 0.0;
};

inline RodState operator+(const RodState& x, const RodState& y) {
  return {x.w + y.w, x.a1 + y.a1, x.a2 + y.a2, x.a3 + y.a3, x.r1 + y.r1, x.r2 + y.r2, x.r3 + y.r3};
}

inline RodState operator*(double h, const RodState& y) {
  return {h * y.w, h * y.a1, h * y.a2, h * y.a3, h * y.r1, h * y.r2, h * y.r3};
}

inline constexpr int kSteps = 20;

/// dq/dsigma = -q u / 2, dr/dsigma = -d3, u = u0 + K^-1 R^T (F x r): (1), (2), (4) to (6) from the tip, M = 0.
inline RodState slope(const RodState& y, const Vector3d& F, const Vector3d& compliance, const Vector3d& u0) {
  const double w = y.w, a1 = y.a1, a2 = y.a2, a3 = y.a3;
  const double m1 = F(1) * y.r3 - F(2) * y.r2, m2 = F(2) * y.r1 - F(0) * y.r3, m3 = F(0) * y.r2 - F(1) * y.r1;
  const double t1 = 2.0 * (a2 * m3 - a3 * m2), t2 = 2.0 * (a3 * m1 - a1 * m3), t3 = 2.0 * (a1 * m2 - a2 * m1);
  const double u1 = u0(0) + compliance(0) * (m1 - w * t1 + a2 * t3 - a3 * t2);
  const double u2 = u0(1) + compliance(1) * (m2 - w * t2 + a3 * t1 - a1 * t3);
  const double u3 = u0(2) + compliance(2) * (m3 - w * t3 + a1 * t2 - a2 * t1);
  return {0.5 * (a1 * u1 + a2 * u2 + a3 * u3), -0.5 * (w * u1 + a2 * u3 - a3 * u2), -0.5 * (w * u2 + a3 * u1 - a1 * u3),
          -0.5 * (w * u3 + a1 * u2 - a2 * u1), -2.0 * (a1 * a3 + w * a2),           -2.0 * (a2 * a3 - w * a1),
          2.0 * (a1 * a1 + a2 * a2) - 1.0};
}

/// Classical Runge-Kutta, then the unit norm restored.
inline void integrate(double length_m, int steps, const Vector3d& F, const Vector3d& compliance, const Vector3d& u0,
                      RodState& y) {
  const double h = length_m / steps;
  for (int i = 0; i < steps; ++i) {
    const RodState k1 = slope(y, F, compliance, u0);
    const RodState k2 = slope(y + 0.5 * h * k1, F, compliance, u0);
    const RodState k3 = slope(y + 0.5 * h * k2, F, compliance, u0);
    const RodState k4 = slope(y + h * k3, F, compliance, u0);
    y = y + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
  }
  const double norm = std::sqrt(y.w * y.w + y.a1 * y.a1 + y.a2 * y.a2 + y.a3 * y.a3);
  y.w /= norm, y.a1 /= norm, y.a2 /= norm, y.a3 /= norm;
}

inline Pose pose(const RodState& y) {
  return {Eigen::Quaterniond(y.w, y.a1, y.a2, y.a3).toRotationMatrix(), {y.r1, y.r2, y.r3}};
}

/// The sensors under a tip force [N, tip axes]. The steps are shared out so that one ends at the second sensor.
inline SensorPoses solve_rod(const Shaft& shaft, const Vector3d& force_tip_N) {
  const Vector3d compliance = shaft.stiffness_Nm2.cwiseInverse();
  const double tip_part_m = shaft.length_m - shaft.behind_m;
  const int tip_steps = std::clamp(static_cast<int>(std::lround(kSteps * tip_part_m / shaft.length_m)), 1, kSteps - 1);
  RodState y;
  integrate(tip_part_m, tip_steps, force_tip_N, compliance, shaft.precurvature_per_m, y);
  const Pose T_tip_behind = pose(y);
  integrate(shaft.behind_m, kSteps - tip_steps, force_tip_N, compliance, shaft.precurvature_per_m, y);
  const Pose T_base_tip = pose(y).inverse();
  return {T_base_tip, T_base_tip * T_tip_behind};
}

/// Rows of y (-) h(F): the raw poses of both sensors, or the paper's Eq. (11), tip pose and omega_se, with the
/// orientation on SO(3) as its Euler angles are singular inside the working range.
inline constexpr int kPoseRows = 12, kPaperRows = 9;

template <int Rows>
using Residual = Eigen::Matrix<double, Rows, 1>;

inline Eigen::Matrix<double, 6, 1> pose_residual(const Pose& measured, const Pose& predicted) {
  Eigen::Matrix<double, 6, 1> r;
  r << measured.p - predicted.p, log_so3(predicted.R.transpose() * measured.R);
  return r;
}

template <int Rows>
Residual<Rows> residual(const Shaft& shaft, const SensorPoses& measured, const Vector3d& force_tip_N) {
  const SensorPoses predicted = solve_rod(shaft, force_tip_N);
  Residual<Rows> r;
  r.template head<6>() = pose_residual(measured.tip, predicted.tip);
  if constexpr (Rows == kPoseRows)
    r.template tail<6>() = pose_residual(measured.behind, predicted.behind);
  else
    r.template tail<3>() = (log_so3(measured.behind.R.transpose() * measured.tip.R) -
                            log_so3(predicted.behind.R.transpose() * predicted.tip.R)) /
                           (shaft.length_m - shaft.behind_m);
  return r;
}

/// J by central differences, r(F + dF) = r(F) - J dF: six rods.
template <int Rows>
Eigen::Matrix<double, Rows, 3> jacobian(const Shaft& shaft, const SensorPoses& measured, const Vector3d& force_tip_N) {
  constexpr double kStep_N = 1e-5;
  Eigen::Matrix<double, Rows, 3> J;
  for (int i = 0; i < 3; ++i) {
    const Vector3d d = kStep_N * Vector3d::Unit(i);
    J.col(i) = (residual<Rows>(shaft, measured, force_tip_N - d) - residual<Rows>(shaft, measured, force_tip_N + d)) /
               (2.0 * kStep_N);
  }
  return J;
}

struct Belief {
  Vector3d force_tip_N = Vector3d::Zero();
  Matrix3d covariance_N2 = Matrix3d::Zero();
};

inline constexpr int kIterations = 10;

/// Section 3.3.1 of the paper: ten full Gauss-Newton steps, seven rods each.
///   (P^-1 + J^T R^-1 J) dF = J^T R^-1 r + P^-1 (F0 - F)
/// `noise_information`: R^-1. Where the iteration leaves the finite numbers the prediction stays.
template <int Rows>
Belief iekf_update(const Shaft& shaft, const Belief& prior, const SensorPoses& measured,
                   const Eigen::Matrix<double, Rows, Rows>& noise_information) {
  const Matrix3d prior_information = prior.covariance_N2.llt().solve(Matrix3d::Identity());
  Vector3d F = prior.force_tip_N;
  Eigen::LLT<Matrix3d> information;
  for (int i = 0; i < kIterations; ++i) {
    const Residual<Rows> r = residual<Rows>(shaft, measured, F);
    const Eigen::Matrix<double, Rows, 3> J = jacobian<Rows>(shaft, measured, F);
    const Eigen::Matrix<double, 3, Rows> JtW = J.transpose() * noise_information;
    information.compute(prior_information + JtW * J);
    F += information.solve(JtW * r + prior_information * (prior.force_tip_N - F));
  }
  if (!F.allFinite()) return prior;
  return {F, information.solve(Matrix3d::Identity())};
}

}  // namespace palpate::textbook
