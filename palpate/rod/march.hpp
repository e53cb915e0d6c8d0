// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/rod/march_kernel.hpp>
#include <palpate/rod/step_rule.hpp>

/// One rod, from the tip towards the clamp: value and tangents side by side in SIMD lanes. What passes between
/// RodSolver and its kernels. The kernels are compiled once for each instruction set, the rest of the program for the
/// narrowest: only plain numbers cross, so that no inline function of the standard library or of Eigen is compiled
/// twice, and none for a processor that the program does not run on.
namespace palpate::rod_lanes {

/// Column 0 is the value, columns 1..N are its tangents along N directions; the columns up to a multiple of
/// kColumnStep hold zeros.
inline constexpr int kMostColumns = 16, kColumnStep = 8;
using Columns = double[kMostColumns];

/// Rows w, a (3), r (3), rho (3) of field.hpp, in metres; rho for the full field only. Of a tangent: nothing, phi, dr,
/// drho.
struct alignas(64) MarchState {
  Columns rows[10];
};

/// One piece of the rod under one load; the directions' column 0 is zero.
struct alignas(64) MarchField {
  Columns d_force_N[3], d_moment_Nm[3], d_distributed_N_per_m[3], d_log_stiffness[3], d_free_curvature_per_m[3];
  double force_N[3], moment_Nm[3], distributed_N_per_m[3];
  double compliance_per_Nm2[3];  ///< diagonal of K^-1; zero in a rigid section
  double free_curvature_per_m[3];
  double shear_compliance_per_N[3];
};

/// What else is known of the rod where a piece ends, in local components: value and tangents.
struct alignas(64) MarchRecord {
  Columns curvature_per_m[3], strain[3], force_N[3], moment_Nm[3];
};

struct MarchPiece {
  double from_sigma_m = 0.0, length_m = 0.0;
  Steps steps = {1, false};
};

MarchKernel march_baseline, march_avx2, march_avx512;

}  // namespace palpate::rod_lanes
