// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/math/pose.hpp>
#include <palpate/rod/instruction_set.hpp>
#include <palpate/rod/march_kernel.hpp>
#include <palpate/rod/rod.hpp>
#include <palpate/rod/step_rule.hpp>
#include <span>
#include <vector>

/// The fast path: with the tip wrench given in tip-frame components, the shape of the clamped rod is one initial-value
/// problem from the tip to the clamp (field.hpp). No boundary-value problem, no iteration.
namespace palpate {

/// What loads the rod, in components of the local frame at the flexible end (the tip frame), and how the shaft differs
/// from its description: of all that, LoadDirections are the derivatives.
struct TipLoad {
  Vector3d force_tip_N = Vector3d::Zero();              ///< of the tissue on the tip, at Rod::contact_offset_m
  Vector3d moment_tip_Nm = Vector3d::Zero();            ///< free moment at the tip; a tendon's end moment goes here
  Vector3d tendon_couple_Nm = Vector3d::Zero();         ///< constant in local components along the shaft
  Vector3d distributed_tip_N_per_m = Vector3d::Zero();  ///< uniform load turned into the tip frame (base_loads.hpp)
  Vector3d log_stiffness = Vector3d::Zero();  ///< of (EI1, EI2, GJ) over those described; all flexible sections alike
  Vector3d precurvature_per_m = Vector3d::Zero();  ///< added to that described; all flexible sections alike
};

/// exp(-log_stiffness): by what the compliance of every flexible section is multiplied. Most loads leave the shaft as
/// described and pay for no exponential.
inline Vector3d compliance_factor(const TipLoad& load) {
  if (load.log_stiffness.isZero(0.0)) return Vector3d::Ones();
  return (-load.log_stiffness).array().exp();
}

/// N directions in parameter space: column j is the derivative of every input along direction j.
template <int N>
struct LoadDirections {
  using Columns = Eigen::Matrix<double, 3, N>;
  Columns force_tip_N = Columns::Zero();
  Columns moment_tip_Nm = Columns::Zero();
  Columns tendon_couple_Nm = Columns::Zero();
  Columns log_stiffness = Columns::Zero();
  Columns precurvature_per_m = Columns::Zero();
  Columns distributed_tip_N_per_m = Columns::Zero();
};

/// The rod at one arc length.
struct RodPoint {
  Pose T_base_local;
  Vector3d curvature_per_m = Vector3d::Zero();  ///< u = (k1, k2, tau), local
  Vector3d shear_strain = Vector3d::Zero();     ///< v - e3, local; zero for a Kirchhoff rod
  Vector3d force_local_N = Vector3d::Zero();    ///< n, internal, of the distal on the proximal part
  Vector3d moment_local_Nm = Vector3d::Zero();  ///< m = K (u - u0)
};

/// Derivatives of a RodPoint along N directions, one column each.
template <int N>
struct RodPointTangent {
  using Columns = Eigen::Matrix<double, 3, N>;
  Columns rotation = Columns::Zero();    ///< body side: delta R = R hat(rotation)
  Columns position_m = Columns::Zero();  ///< base components
  Columns curvature_per_m = Columns::Zero();
  Columns shear_strain = Columns::Zero();
  Columns force_local_N = Columns::Zero();
  Columns moment_local_Nm = Columns::Zero();
};

/// Solution at the requested stations, in the order requested, and at the flexible end. Owned by the caller and reused.
template <int N>
struct RodSolution {
  std::vector<RodPoint> points;
  std::vector<RodPointTangent<N>> tangents;                                        ///< empty for N = 0
  Pose T_base_tip;                                                                 ///< flexible end
  Eigen::Matrix<double, 3, N> tip_rotation = Eigen::Matrix<double, 3, N>::Zero();  ///< its tangent, body side
};

enum class Accuracy {
  kRealtime,   ///< 1e-6 of the length on the paper's catheter up to 0.4 N: the filters' default
  kReference,  ///< 1e-8 of the length
};

/// A rod cut at its section boundaries and at the stations of interest, ready to be integrated. Immutable.
class RodSolver {
 public:
  /// `arc_lengths_m`: stations in [0, length + rigid tip], any order. Throws InputError on a station outside,
  /// and on instructions that this processor lacks.
  /// At a section boundary the strain is that of the section on the tip's side.
  RodSolver(Rod rod, std::span<const double> arc_lengths_m, Accuracy accuracy = Accuracy::kRealtime,
            InstructionSet instructions = preferred_instruction_set());

  const Rod& rod() const { return rod_; }
  std::span<const double> arc_lengths_m() const { return arc_lengths_m_; }

  template <int N>
  RodSolution<N> make_solution() const;

  /// Shape under `load`. One integration; no allocation, no exception. Instantiated for N = 0, 3, 6, 9, 12, 15.
  template <int N>
  void solve(const TipLoad& load, const LoadDirections<N>& directions, RodSolution<N>& solution) const;
  void solve(const TipLoad& load, RodSolution<0>& solution) const { solve<0>(load, {}, solution); }

  const rod_lanes::StepRule& step_rule() const { return step_rule_; }

  /// Largest curvature to expect along the rod [1/m], for the step rule: |u0| + |M|/EI + 2 sqrt(|F|/EI), EI the least
  /// of the stiffnesses, both as `load` changes them. A bound for a uniform rod of equal stiffnesses, along which
  /// u.K.u / 2 + n.d3 is constant; an estimate otherwise.
  double curvature_bound_per_m(const TipLoad& load) const;

  /// Piece of the rod between two stops, from the tip to the clamp.
  struct Piece {
    double from_sigma_m = 0.0;  ///< sigma = L - s
    double length_m = 0.0;
    int section = 0;
    int first_station = 0, end_station = 0;  ///< in tip-to-clamp order, reached at the end of the piece
  };
  std::span<const Piece> pieces() const { return pieces_; }
  std::span<const int> station_order() const { return station_order_; }

 private:
  Rod rod_;
  std::vector<double> arc_lengths_m_;
  std::vector<int> station_order_;  ///< station indices from the tip to the clamp
  int stations_at_tip_ = 0;         ///< how many of them lie at or beyond the flexible end
  std::vector<Piece> pieces_;
  Vector3d least_stiffness_Nm2_ = Vector3d::Zero();  ///< each over the flexible sections, as described
  rod_lanes::StepRule step_rule_;
  rod_lanes::MarchKernel* kernel_;

  template <int N>
  void keep_tip(const rod_lanes::MarchRecord& record, bool full, const TipLoad& load,
                const LoadDirections<N>& directions, RodSolution<N>& solution) const;
};

}  // namespace palpate
