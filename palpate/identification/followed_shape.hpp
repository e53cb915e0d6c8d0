// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/stiffness_unknowns.hpp>
#include <palpate/rod/dead_load.hpp>

/// The shape of the shaft under one load while a fit changes the shaft.
namespace palpate::stiffness {

/// Which of the numbers q may move: the others' columns are left out of the integration.
struct Moving {
  bool shear = false, turn = false, precurvature = false, force = false;
  int columns() const { return 3 + shear + 3 * turn + 3 * precurvature + force; }
};

/// The shaft at a place in the stated base frame, with derivatives by q.
struct Place {
  using Columns = Eigen::Matrix<double, 3, kNumbers>;
  Pose T_base_point;
  Vector3d tangent = Vector3d::Zero();  ///< dp/ds
  Columns by_p = Columns::Zero(), by_rotation = Columns::Zero(), by_tangent = Columns::Zero();
};

/// Equilibria of one shaft under one load, each followed from the one before. Shear stiffness enters as the load: a
/// shape is that of (F, K, Kse), all divided by the change of Kse.
class FollowedShape {
 public:
  FollowedShape(const Rod& rod, std::vector<double> arc_lengths_m, const DeadLoad& load,
                const Vector3d& force_direction, Moving moving);

  /// In one step or, where that leaves the branch, in several. False where the equilibrium was lost. What it found
  /// becomes the start of the next. `closed_rad`: solve_dead_load's tangent_suffices_rad.
  bool solve(const Numbers& q, double closed_rad);
  void restart(const Numbers& q, const Matrix3d& R_tip_base);

  /// Where the next solution starts from.
  struct Start {
    Numbers q = Numbers::Zero();
    Matrix3d R_tip_base = Matrix3d::Identity();
    Eigen::Matrix<double, 3, kNumbers> turn = Eigen::Matrix<double, 3, kNumbers>::Zero();  ///< of Q, by q
    double least_determinant = 1.0;  ///< met since the last restart
  };
  const Start& start() const { return last_; }
  void set_start(const Start& start) { last_ = start; }

  /// Of the stations, in clamp axes, with the sensors' places put in by their mountings. At the last solution.
  std::vector<Place> places(std::span<const Pose> mounts) const;

  int evaluations() const { return evaluations_; }

 private:
  template <int N>
  bool solve_near(const Numbers& q, double closed_rad);
  template <int N>
  void keep(const Numbers& q, const DeadLoadSolution<N>& solution);
  bool solve_in_one(const Numbers& q, double closed_rad);
  DeadLoad load_at(const Numbers& q) const;
  template <int N>
  DeadLoadDirections<N> directions_at(const Numbers& q, const DeadLoad& load) const;

  RodSolver solver_;
  DeadLoad load_;
  Vector3d force_direction_;
  std::vector<int> number_of_column_;
  Start last_;
  std::vector<Place> places_;  ///< of the last solution, clamp axes, without mounting
  int evaluations_ = 0;
};

}  // namespace palpate::stiffness
