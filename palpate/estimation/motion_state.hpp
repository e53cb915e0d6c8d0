// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <palpate/estimation/force_gaussian.hpp>

/// The hidden state behind a moving force. It is made of components, each a vector of three, one number a tip axis:
/// entry 3 c + i belongs to component c, axis i. Capacity is fixed, so resizing never allocates.
namespace palpate {

inline constexpr int kMaxParameters = 96;  ///< of the sensors' model, beside the force
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

/// sum over components of map(c) x_c: 3-vector.
Vector3d force_mean(const ComponentRow& map, const MotionVector& mean);
/// P (map x I3)^T: n x 3.
MotionGain times_map(const MotionMatrix& covariance, const ComponentRow& map);
/// (map x I3) times columns of components: 3 x columns.
template <class Columns>
auto map_times(const ComponentRow& map, const Columns& columns) {
  constexpr int kMost =
      Columns::MaxColsAtCompileTime == Eigen::Dynamic ? kMaxParameters : Columns::MaxColsAtCompileTime;
  Eigen::Matrix<double, 3, Columns::ColsAtCompileTime, Eigen::ColMajor, 3, kMost> out;
  out.setZero(3, columns.cols());
  for (Eigen::Index c = 0; c < map.size(); ++c)
    if (map(c) != 0.0) out += map(c) * columns.template middleRows<3>(3 * c);
  return out;
}
ForceGaussian force_of(const ComponentRow& map, const MotionState& state);

}  // namespace palpate
