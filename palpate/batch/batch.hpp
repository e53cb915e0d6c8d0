// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <palpate/rod/instruction_set.hpp>
#include <palpate/rod/statics.hpp>
#include <span>
#include <vector>

/// Many loads of one rod at a time: side by side in SIMD lanes and over the cores. For campaigns, identification with
/// many points and whoever has arrays.
namespace palpate {

/// TipLoads apart: entry i of every span belongs to rod i. An empty span is zero for all.
struct BatchLoads {
  std::span<const Vector3d> force_tip_N = {};
  std::span<const Vector3d> moment_tip_Nm = {};
  std::span<const Vector3d> tendon_couple_Nm = {};
  std::span<const Vector3d> distributed_tip_N_per_m = {};
  std::span<const Vector3d> log_stiffness = {};
  std::span<const Vector3d> precurvature_per_m = {};
};

/// Structure of arrays: each component a contiguous row over the rods, each rod a column.
using BatchVectors = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
/// 3 x 3 matrices, row 3 i + j holding entry (i, j).
using BatchMatrices = Eigen::Matrix<double, 9, Eigen::Dynamic, Eigen::RowMajor>;

/// One arc length of every rod: as RodPoint, and as RodPointTangent along the three components of the tip force.
struct BatchPoints {
  BatchMatrices R_base_local;
  BatchVectors p_base_local_m;
  BatchVectors curvature_per_m;     ///< (k1, k2, tau), local
  BatchMatrices d_rotation;         ///< rad/N, body side: dR = R hat(d_rotation dF); these three empty unless asked for
  BatchMatrices d_position_m;       ///< m/N, base components
  BatchMatrices d_curvature_per_m;  ///< 1/(m N)

  /// Rod i's rotation.
  Matrix3d R(Eigen::Index i) const { return R_base_local.col(i).reshaped<Eigen::RowMajor>(3, 3); }
};

/// Owned by the caller and reused: solved again with as many rods, it allocates nothing.
struct BatchSolution {
  BatchPoints tip;                    ///< flexible end
  std::vector<BatchPoints> stations;  ///< the solver's, in its order
  /// 0: the rod's load is beyond what a solve is accurate for, or not finite (rod/reach.hpp).
  std::vector<std::uint8_t> within_reach;
};

struct BatchOptions {
  bool force_sensitivities = false;  ///< also the derivatives along the tip force, at about four times the time
  int workers = 0;                   ///< threads to work in; 0: one a core. No effect on the results
  InstructionSet instructions = preferred_instruction_set();

  /// Throws InputError on a negative number of workers and on instructions that this processor lacks.
  void validate() const;
};

/// Solves the rod of `solver` under each load, with the steps that solver.solve() takes: the results are those to
/// rounding (1e-12 of the length), but for internal forces, moments and shear strains, which are not given.
///
/// Each lane takes its own number of steps, so a rod's result is the same bits whatever stands beside it, in whatever
/// order, however many workers there are. Rods of like step counts are put side by side only to waste no lane. A load
/// that is not finite gives a shape that is not, for its own rod alone.
///
/// Throws InputError where sizes differ, and as BatchOptions::validate(). Cost: about a fifth of
/// solver.solve<0>() a rod and core with eight lanes (docs/benchmarks.md); scratch of 100 kB a worker.
void solve_batch(const RodSolver& solver, const BatchLoads& loads, const BatchOptions& options,
                 BatchSolution& solution);

}  // namespace palpate
