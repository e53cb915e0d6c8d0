// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/rod/field.hpp>
#include <palpate/rod/rod.hpp>
#include <palpate/rod/runge_kutta.hpp>
#include <palpate/rod/statics.hpp>

/// From the rod and its load to the field's parameters, along one piece, and from tip-frame states to outputs.
namespace palpate::rod_field {

/// u0 as `load` changes it; a rigid section keeps its own.
inline Vector3d unloaded_curvature(const palpate::Section& section, const TipLoad& load) {
  if (section.rigid) return section.precurvature_per_m;
  return section.precurvature_per_m + load.precurvature_per_m;
}

/// Constants of the field in one section. A rigid section is one without compliance. All that depends on the stiffness
/// does so through `compliance`, whose derivative is -compliance d_log_stiffness at any log_stiffness.
template <int N>
Parameters<double, N> section_parameters(const Rod& rod, const palpate::Section& section, const TipLoad& load,
                                         const LoadDirections<N>& d) {
  Parameters<double, N> p;
  const Vector3d& c = rod.contact_offset_m;
  p.force = load.force_tip_N;
  p.moment = load.moment_tip_Nm + c.cross(load.force_tip_N);
  p.distributed = load.distributed_tip_N_per_m;
  p.compliance =
      section.rigid ? Vector3d::Zero() : Vector3d(compliance_factor(load).cwiseQuotient(section.stiffness_Nm2));
  const Vector3d tendon_curvature = p.compliance.cwiseProduct(load.tendon_couple_Nm);
  p.free_curvature = unloaded_curvature(section, load) + tendon_curvature;
  p.shear_compliance.setZero();
  if (rod.shears() && !section.rigid)
    p.shear_compliance << 1.0 / rod.shear_stiffness_N, 1.0 / rod.shear_stiffness_N, 1.0 / rod.axial_stiffness_N;
  if constexpr (N > 0) {
    p.d_force = d.force_tip_N;
    p.d_moment = d.moment_tip_Nm + hat(c) * d.force_tip_N;
    p.d_distributed = d.distributed_tip_N_per_m;
    p.d_log_stiffness = d.log_stiffness;
    p.d_free_curvature = p.compliance.asDiagonal() * d.tendon_couple_Nm;
    p.d_free_curvature -= tendon_curvature.asDiagonal() * d.log_stiffness;
    if (!section.rigid) p.d_free_curvature += d.precurvature_per_m;
  }
  return p;
}

/// Integrates value and tangents over one piece in equal steps: the one place where the integrator is called.
template <const auto& method, bool Full, class T, int N>
void integrate_piece(const T& from_sigma, const T& length, int steps, const Parameters<T, N>& p, State<T, N, Full>& y) {
  const auto field = [&p](const T& sigma, const State<T, N, Full>& state, State<T, N, Full>& rate) {
    derivative<Full>(sigma, state, p, rate);
  };
  const T h = length / T(steps);
  for (int i = 0; i < steps; ++i) {
    runge_kutta_step<method>(from_sigma + T(i) * h, h, y, field);
    normalise<Full, T, N>(y);
  }
}

/// Stores station values still relative to the tip frame; to_base_frame() finishes them.
template <bool Full, int N>
void record(double sigma, const State<double, N, Full>& y, const Parameters<double, N>& p, const TipLoad& load,
            const LoadDirections<N>& d, int station, RodSolution<N>& solution) {
  const Section<double, N> o = section<Full>(sigma, y, p);
  RodPoint& point = solution.points[station];
  point.T_base_local = {o.R, y.template block<3, 1>(4, 0)};
  point.curvature_per_m = o.u;
  if constexpr (Full) point.shear_strain = o.shear;
  point.force_local_N = o.R.transpose() * o.n;
  const Vector3d moment = o.R.transpose() * o.mu;
  point.moment_local_Nm = moment + load.tendon_couple_Nm;
  if constexpr (N > 0) {
    RodPointTangent<N>& tangent = solution.tangents[station];
    tangent.rotation = rotation_tangent<Full, double, N>(y);
    tangent.position_m = y.template block<3, N>(4, 1);
    tangent.curvature_per_m = o.d_u;
    if constexpr (Full) tangent.shear_strain = o.d_shear;
    tangent.force_local_N = o.R.transpose() * o.d_n + hat(point.force_local_N) * tangent.rotation;
    tangent.moment_local_Nm = o.R.transpose() * o.d_mu + hat(moment) * tangent.rotation + d.tendon_couple_Nm;
  }
}

/// Station `beyond_m` past the flexible end, on the rigid tip, whose axes are the tip frame's.
template <int N>
void record_rigid_tip(const Rod& rod, const TipLoad& load, const LoadDirections<N>& d, double beyond_m, int station,
                      RodSolution<N>& solution) {
  const palpate::Section& last = rod.sections.back();
  const bool at_flexible_end = beyond_m < 1e-12 * rod.length_m();
  const Parameters<double, N> p = section_parameters(rod, last, load, d);
  State<double, N, true> y = State<double, N, true>::Zero();
  y(0, 0) = 1.0;
  record<true>(0.0, y, p, load, d, station, solution);
  if (at_flexible_end) return;
  const Vector3d offset(0.0, 0.0, beyond_m);
  RodPoint& point = solution.points[station];
  point.T_base_local.p = offset;
  point.curvature_per_m.setZero();
  point.shear_strain.setZero();
  point.moment_local_Nm -= offset.cross(load.force_tip_N) + load.tendon_couple_Nm;
  if constexpr (N > 0) {
    RodPointTangent<N>& tangent = solution.tangents[station];
    tangent.curvature_per_m.setZero();
    tangent.shear_strain.setZero();
    tangent.moment_local_Nm -= hat(offset) * d.force_tip_N + d.tendon_couple_Nm;
  }
}

/// T_base_local = T_tip_base^-1 T_tip_local, with `y` the state at the clamp.
template <bool Full, int N>
void to_base_frame(const State<double, N, Full>& y, RodSolution<N>& solution) {
  const Mat3<double> R_base_tip = rotation<double>(y(0, 0), y.template block<3, 1>(1, 0)).transpose();
  const Vector3d r_clamp = y.template block<3, 1>(4, 0);
  Cols<double, N> clamp_rotation = Cols<double, N>::Zero(), clamp_position = Cols<double, N>::Zero();
  if constexpr (N > 0) {
    clamp_rotation = rotation_tangent<Full, double, N>(y);
    clamp_position = y.template block<3, N>(4, 1);
  }
  for (std::size_t i = 0; i < solution.points.size(); ++i) {
    Pose& T = solution.points[i].T_base_local;
    T = {R_base_tip * T.R, R_base_tip * (T.p - r_clamp)};
    if constexpr (N > 0) {
      RodPointTangent<N>& tangent = solution.tangents[i];
      tangent.rotation -= T.R.transpose() * clamp_rotation;
      tangent.position_m = R_base_tip * (tangent.position_m - clamp_position) + hat(T.p) * clamp_rotation;
    }
  }
  solution.T_base_tip = {R_base_tip, -(R_base_tip * r_clamp)};
  if constexpr (N > 0) solution.tip_rotation = -(R_base_tip.transpose() * clamp_rotation);
}

}  // namespace palpate::rod_field
