// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/rod/statics.hpp>

/// Loads fixed in the base frame: a dead weight on the tip, gravity along the shaft, a uniform load. The tip frame's
/// direction is then part of the answer, so one unknown rotation closes the loop around the fast path:
///
///   find Q = R_tip_base with  Q = R_tip_base(F_tip + Q F_base, g = Q w),   e = log(Q^T R_tip_base) = 0
///
/// solved by Newton's method on SO(3) with the rod's own sensitivities.
namespace palpate {

// ---------------------------------------------------------------------------------------------------------------
// Own weight under a known tip force: what the estimator's measurement model needs.

template <int N>
struct WeightWorkspace {
  RodSolution<0> value;
  RodSolution<N + 3> tangent;  ///< the last three columns: the distributed load in tip components
};

template <int N>
WeightWorkspace<N> make_weight_workspace(const RodSolver& solver);

struct WeightedSolve {
  bool converged = true;
  int evaluations = 0;  ///< integrations of the rod
};

/// Fast path with the rod's own distributed load (Rod::distributed_load_base_N_per_m; `load`'s is ignored). Without one
/// it is a single integration. `solution` carries the total derivatives, the turning of the weight included; here the
/// distributed column of `directions` is a change of the load in base components.
/// At most 25 integrations; not converged: `solution` is the last iterate. No allocation. N = 3, 6, 9 and 12.
template <int N>
WeightedSolve solve_under_weight(const RodSolver& solver, const TipLoad& load, const LoadDirections<N>& directions,
                                 WeightWorkspace<N>& workspace, RodSolution<N>& solution);

// ---------------------------------------------------------------------------------------------------------------
// Equilibria under dead loads: several may exist; the one connected to the unloaded rod is followed.

struct BaseLoad {
  Vector3d force_base_N = Vector3d::Zero();  ///< dead load at the contact point
  TipLoad tip;                               ///< what turns with the tip; its distributed part is ignored
};

enum class EquilibriumStatus {
  kStable,
  kUnstable,       ///< an equilibrium, but the load path passed a bifurcation: a real rod has left this branch
  kAtBifurcation,  ///< the branch from rest ends, turns too sharply to be followed, or is about to lose stability, here
};

struct Equilibrium {
  EquilibriumStatus status = EquilibriumStatus::kStable;
  double load_factor = 0.0;           ///< share of the load that was reached; 1: all of it
  double critical_load_factor = 0.0;  ///< where stability was lost; 0: nowhere on the way
  TipLoad load;                       ///< in tip components, at load_factor
  Pose T_base_tip;
  /// Least eigenvalue of d moment_tip / d rotation_tip [N m/rad]: what holds the tip against turning. Positive all
  /// along the path from rest: stable.
  double least_tip_stiffness_Nm = 0.0;
  /// det(dF_base/dF_tip) for a pure tip force; 1 for the unloaded rod, 0 at a bifurcation.
  double determinant = 1.0;
  int evaluations = 0;
};

/// Follows the equilibrium from zero to the full load by continuation with adaptive steps; the rod's distributed load
/// grows along. Never jumps: a step that ends more than 0.05 rad from the extrapolated tip rotation is refused and
/// halved, and so is one from a stable to an unstable place without a crossing between them. Allocates.
Equilibrium follow_from_rest(const RodSolver& solver, const BaseLoad& load);

}  // namespace palpate
