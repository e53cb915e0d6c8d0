// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <palpate/estimation/force_gaussian.hpp>

/// The hidden state behind a moving force. It is made of components, each a vector of three, one number a tip axis:
/// entry 3 c + i belongs to component c, axis i. Capacity is fixed, so resizing never allocates.
namespace palpate {

inline constexpr int kMaxHeartHarmonics = 3, kMaxBreathingHarmonics = 2;
inline constexpr int kMaxOscillators = kMaxHeartHarmonics + kMaxBreathingHarmonics;
inline constexpr int kMaxMotionComponents = 2 + 2 * kMaxOscillators + 1;  ///< level, rate, oscillators, disturbance
inline constexpr int kMaxMotionStates = 3 * kMaxMotionComponents;

using MotionVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxMotionStates, 1>;
using MotionMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxMotionStates, kMaxMotionStates>;
using MotionGain = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, kMaxMotionStates, 3>;
/// How the components of one axis depend on each other; the same for each axis.
using ComponentMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxMotionComponents, kMaxMotionComponents>;
/// Row of a map from components to force: 0 or 1 each.
using ComponentRow = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, kMaxMotionComponents>;

/// N(mean, covariance) of all components; n = 3 x components.
struct MotionState {
  MotionVector mean;
  MotionMatrix covariance;
};

/// What conditioning on a new knowledge of F = H x did: x+ = x- + K (F+ - F-), with K = P- H^T S^-1, S = H P- H^T. Any
/// variable with covariance X with x (the force of an earlier frame) is corrected alike, by its own gain X H^T S^-1.
struct ForceCorrection {
  Eigen::LLT<Matrix3d> seen_covariance;   ///< factor of S
  MotionGain gain;                        ///< K, n x 3
  Vector3d shift_N = Vector3d::Zero();    ///< F+ - F-
  Matrix3d change_N2 = Matrix3d::Zero();  ///< P_F+ - S
  ComponentRow seen;                      ///< H, per axis

  /// Of a frame that changes nothing.
  static ForceCorrection none(const ComponentRow& seen);
};

/// sum over components of map(c) x_c: 3-vector.
Vector3d force_mean(const ComponentRow& map, const MotionVector& mean);
/// P (map x I3)^T: n x 3.
MotionGain times_map(const MotionMatrix& covariance, const ComponentRow& map);
/// map (n x 3 matrix): 3 x 3.
Matrix3d map_times(const ComponentRow& map, const MotionGain& columns);
ForceGaussian force_of(const ComponentRow& map, const MotionState& state);

/// Conditions the state on F = H x having become N(F+, P_F+): x+ = x- + K (F+ - F-), P+ = P- + K (P_F+ - S) K^T,
/// symmetrised. Exact for linear-Gaussian states, whichever update found the posterior. False, and the state as it was,
/// where S is not positive definite or a variance would be lost. Cost about 9 n^2 products; no allocation.
bool condition(const ComponentRow& seen, const ForceGaussian& posterior, MotionState& state,
               ForceCorrection& correction);

}  // namespace palpate
