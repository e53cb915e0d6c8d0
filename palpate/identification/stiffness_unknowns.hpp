// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <palpate/identification/stiffness.hpp>

/// What a fit of the stiffness moves, z, and what that does to the shaft, q(z).
namespace palpate::stiffness {

/// q: every number that shapes what is seen, as deviations from the catheter file. Rows, in this order.
inline constexpr int kLogStiffness = 0;  ///< of EI1, EI2, GJ
inline constexpr int kLogShear = 3;      ///< of shear and axial stiffness together
inline constexpr int kTurn = 4;          ///< rotation vector of the clamp against the stated base frame [rad]
inline constexpr int kShift = 7;         ///< of the clamp [m]
inline constexpr int kPrecurvature = 10;
inline constexpr int kExtraForce = 13;  ///< beside the stated load, along a direction of choice [N]
inline constexpr int kNumbers = 14;
using Numbers = Eigen::Matrix<double, kNumbers, 1>;
using NumbersByUnknown = Eigen::Matrix<double, kNumbers, Eigen::Dynamic>;

/// z = (logarithms of the stiffnesses that are free, nuisances). A nuisance is in units of its prior's sigma: clamp
/// pose and precurvature are q = prior_root * nuisance, each nuisance N(0, 1).
class Unknowns {
 public:
  Unknowns(const Catheter& catheter, const StiffnessOptions& options);

  struct Stiffness {
    std::string name;
    double described = 1.0;  ///< value at logarithm 0
    bool free = true;
  };
  const std::vector<Stiffness>& stiffnesses() const { return stiffnesses_; }
  void hold(int stiffness) { stiffnesses_[stiffness].free = false; }

  int free_stiffnesses() const;
  int nuisances() const { return static_cast<int>(prior_root_.cols()); }
  int size() const { return free_stiffnesses() + nuisances(); }
  int index_of(int stiffness) const;  ///< in z; -1: held

  Numbers numbers(const Eigen::VectorXd& z) const;
  NumbersByUnknown derivative(const Eigen::VectorXd& z) const;
  /// q where all stiffnesses have the same logarithm.
  Numbers scaled(double log_scale) const;
  Eigen::VectorXd start(double log_scale) const;

  /// As the catheter file describes it, GJ by Poisson's ratio where that was asked.
  const Rod& described() const { return described_; }
  Rod identified(const Eigen::VectorXd& z) const;

 private:
  double log_of(int stiffness, const Eigen::VectorXd& z) const;
  Vector3d bending_shares(const Eigen::VectorXd& z, double& log_sum) const;

  StiffnessOptions options_;
  Rod described_;
  Vector3d reference_Nm2_;  ///< of the first flexible section: whose shares of EI1 + EI2 count
  std::vector<Stiffness> stiffnesses_;
  Eigen::Matrix<double, 9, Eigen::Dynamic> prior_root_;  ///< of rows kTurn, kShift, kPrecurvature
};

}  // namespace palpate::stiffness
