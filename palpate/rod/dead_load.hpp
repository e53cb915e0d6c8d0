// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/rod/base_loads.hpp>

/// Equilibrium under a dead load with its exact derivatives, from a tip direction that is nearly right: what a fit asks
/// for again and again. The loop is that of base_loads.hpp,
///
///   find Q = R_tip_base with  e = log(Q^T R_tip_base(F_tip + Q F_base, g = Q w)) = 0 .
///
/// Newton's method stays on the branch of its start; follow_from_rest() says which branch is the right one.
namespace palpate {

struct DeadLoad {
  Vector3d force_base_N = Vector3d::Zero();              ///< at the contact point
  Vector3d distributed_base_N_per_m = Vector3d::Zero();  ///< instead of Rod::distributed_load_base_N_per_m
  TipLoad tip;                                           ///< what turns with the tip; its distributed part is ignored
};

/// Here the distributed column is a change of the load in base components.
template <int N>
struct DeadLoadDirections : LoadDirections<N> {
  typename LoadDirections<N>::Columns force_base_N = LoadDirections<N>::Columns::Zero();
};

template <int N>
struct DeadLoadSolution {
  RodSolution<N> shape;              ///< with total derivatives: the turning of the loads is included
  Matrix3d R_tip_base;               ///< Q
  Eigen::Matrix<double, 3, N> turn;  ///< of Q, body side: Q exp(turn dp)
  double determinant = 1.0;          ///< det(-de/dQ) = det(dF_base/dF_tip); 0 at a bifurcation
  RodSolution<N + 3> partial;        ///< work space; the last three columns: by Q
};

template <int N>
DeadLoadSolution<N> make_dead_load_solution(const RodSolver& solver);

/// Newton from `R_tip_base`, which is left alone. A last step below `tangent_suffices_rad` is taken along the tangent,
/// so that the shape is right to about its square and the derivatives to itself; T_base_tip.p is not moved along. Not
/// converged within 12 integrations, or a step over 0.5 rad: `solution` is of no use. No allocation. N = 3, 6, 9
/// and 12.
template <int N>
WeightedSolve solve_dead_load(const RodSolver& solver, const DeadLoad& load, const DeadLoadDirections<N>& directions,
                              const Matrix3d& R_tip_base, DeadLoadSolution<N>& solution,
                              double tangent_suffices_rad = 1e-6);

}  // namespace palpate
