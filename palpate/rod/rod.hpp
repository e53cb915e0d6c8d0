// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/math/rotation.hpp>
#include <vector>

namespace palpate {

/// Bending about d1, bending about d2, torsion about d3: (EI1, EI2, GJ) in N m^2.
using Stiffness = Vector3d;

/// GJ = (EI1 + EI2) / (2 (1 + nu)), the paper's tie for CFSE (section 3.1.2).
double torsional_stiffness_Nm2(double EI1_Nm2, double EI2_Nm2, double poisson_ratio);

/// Solid round shaft: EI = E pi d^4 / 64 in both directions, GJ by Poisson's ratio.
Stiffness round_shaft_stiffness(double youngs_modulus_Pa, double diameter_m, double poisson_ratio);

/// Stretch of shaft [from, to) along arc length with constant properties.
struct Section {
  double from_m = 0.0;
  double to_m = 0.0;
  Stiffness stiffness_Nm2 = Stiffness::Zero();
  Vector3d precurvature_per_m = Vector3d::Zero();  ///< (k1,0, k2,0, tau0), local components
  bool rigid = false;                              ///< keeps its precurvature under any load; stiffness unused
};

/// Clamped elastic rod in its unloaded state: what does not change while it is watched.
/// Base frame B: clamp at s = 0, e3 along the straight shaft. Local frame at s: columns d1, d2, d3 = tangent.
struct Rod {
  std::vector<Section> sections;                 ///< from the clamp to the flexible end, without gaps
  double rigid_tip_m = 0.0;                      ///< stiff electrode beyond the flexible end
  Vector3d contact_offset_m = Vector3d::Zero();  ///< where the tip force acts, from the flexible end, local axes there
  double shear_stiffness_N = 0.0;                ///< kGA; 0 with axial 0: no shear, no stretch (Kirchhoff)
  double axial_stiffness_N = 0.0;                ///< EA
  Vector3d distributed_load_base_N_per_m = Vector3d::Zero();  ///< own weight or another uniform load, base frame

  double length_m() const { return sections.back().to_m; }
  /// The section whose stiffness and bend stand for the shaft's; where all are rigid, the first.
  const Section& first_flexible() const;
  bool shears() const { return shear_stiffness_N > 0.0; }
  bool has_distributed_load() const { return !distributed_load_base_N_per_m.isZero(0.0); }

  /// Throws InputError naming the offending section and value.
  void validate() const;
};

/// The common case: one section, constant properties.
Rod uniform_rod(double length_m, const Stiffness& stiffness_Nm2, const Vector3d& precurvature_per_m);

}  // namespace palpate
