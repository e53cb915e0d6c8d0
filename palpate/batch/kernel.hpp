// SPDX-License-Identifier: Apache-2.0
#pragma once

/// What passes between the batch solver and its kernels. The kernels are compiled once for each instruction set, the
/// rest of the program for the narrowest: only plain numbers cross, so that no inline function of the standard library
/// or of Eigen is compiled twice, and none for a processor that the program does not run on.
namespace palpate::rod_lanes {

/// Rods that stand side by side: as many as the widest lanes hold. Narrower ones go over a block several times.
inline constexpr int kBlock = 8;

/// One number of each rod of a block.
using Row = double[kBlock];

/// RodSolver::Piece and its section.
struct Piece {
  double from_sigma_m, length_m;
  double stiffness_Nm2[3];  ///< unused in a rigid section
  double precurvature_per_m[3];
  bool rigid;
  int first_point, end_point;  ///< points reached at its end
};

/// The rod, alike for all lanes. Points: 0 is the flexible end, then the stations from the tip to the clamp.
struct Plan {
  const Piece* pieces;
  int piece_count;
  const double* beyond_m;  ///< how far past the flexible end each of the first points lies
  int points_at_tip;       ///< number of those, point 0 among them
  int point_count;
  double contact_offset_m[3];
  double shear_compliance[3];  ///< per N; zero: no shear, no stretch
};

/// TipLoad of each rod. The moment is that at the flexible end, M + c x F.
struct alignas(64) Loads {
  Row force_N[3], moment_Nm[3], couple_Nm[3], distributed_N_per_m[3];
  Row compliance_factor[3];
  Row precurvature_per_m[3];
};

/// One point of each rod. R row-major; derivatives with respect to F: row 3 i + j is component i along F_j.
struct alignas(64) Point {
  Row R[9], p_m[3], curvature_per_m[3];
  Row d_rotation[9], d_position_m[9], d_curvature_per_m[9];
};

/// What is solved: the field with shear and distributed load or without, with derivatives or without.
struct Kind {
  bool full, sensitivities;
};

/// Among step counts: a single step, of the method of order 6.
inline constexpr double kOneOfOrder6 = -1.0;

/// Solves the first `lanes` rods of a block. `steps`: one row a piece. Writes plan.point_count points in the base
/// frame.
using Kernel = void(const Plan& plan, Kind kind, const Loads& loads, const Row* steps, int lanes, Point* points);
Kernel solve_baseline, solve_avx2, solve_avx512;

}  // namespace palpate::rod_lanes
