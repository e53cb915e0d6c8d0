// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

/// Vectors and matrices between sensing and estimation. Their capacity is fixed, so resizing never allocates.
namespace palpate {

inline constexpr int kMaxStates = 16;
inline constexpr int kMaxResiduals = 54;  ///< eight 6-DOF sensors, a known force, and what is believed of it

using StateVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxStates, 1>;
using StateMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxStates, kMaxStates>;
using ResidualVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxResiduals, 1>;
using ResidualMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxResiduals, kMaxResiduals>;
using JacobianMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxResiduals, kMaxStates>;

/// A nonlinear measurement at one state x: residual r = y (-) h(x) and J with r(x + dx) = r(x) - J dx + O(dx^2).
struct Linearization {
  ResidualVector residual;
  JacobianMatrix jacobian;
};

/// Row i of a measurement belongs to channel[i], a stable number of one scalar quantity (say, z of the tip sensor),
/// whichever sensors a frame happens to carry.
using Channels = std::array<int, kMaxResiduals>;

}  // namespace palpate
