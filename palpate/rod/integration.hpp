// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/rod/march.hpp>
#include <palpate/rod/rod.hpp>
#include <palpate/rod/statics.hpp>

/// From the rod and its load to what the kernels read, and from tip-frame states to outputs.
namespace palpate::rod_lanes {

/// u0 as `load` changes it; a rigid section keeps its own.
inline Vector3d unloaded_curvature(const Section& section, const TipLoad& load) {
  if (section.rigid) return section.precurvature_per_m;
  return section.precurvature_per_m + load.precurvature_per_m;
}

inline void set(const Vector3d& v, double* out) {
  for (int i = 0; i < 3; ++i) out[i] = v(i);
}

/// Rows of `m` into columns 1..N; zero before and behind.
template <int N>
void set_columns(const Eigen::Matrix<double, 3, N>& m, Columns* rows) {
  constexpr int padded = (N + kColumnStep) / kColumnStep * kColumnStep;
  for (int i = 0; i < 3; ++i) {
    rows[i][0] = 0.0;
    for (int j = 0; j < N; ++j) rows[i][1 + j] = m(i, j);
    for (int j = N + 1; j < padded; ++j) rows[i][j] = 0.0;
  }
}
template <int N>
Eigen::Matrix<double, 3, N> columns(const Columns* rows) {
  Eigen::Matrix<double, 3, N> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < N; ++j) m(i, j) = rows[i][1 + j];
  return m;
}
inline Vector3d value(const Columns* rows) { return {rows[0][0], rows[1][0], rows[2][0]}; }

/// What all sections share.
template <int N>
void set_load(const Rod& rod, const TipLoad& load, const LoadDirections<N>& d, MarchField& field) {
  const Vector3d& c = rod.contact_offset_m;
  set(load.force_tip_N, field.force_N);
  set(load.moment_tip_Nm + c.cross(load.force_tip_N), field.moment_Nm);
  set(load.distributed_tip_N_per_m, field.distributed_N_per_m);
  set_columns<N>(d.force_tip_N, field.d_force_N);
  set_columns<N>(d.moment_tip_Nm + hat(c) * d.force_tip_N, field.d_moment_Nm);
  set_columns<N>(d.distributed_tip_N_per_m, field.d_distributed_N_per_m);
  set_columns<N>(d.log_stiffness, field.d_log_stiffness);
}

/// What one section adds. A rigid one is one without compliance. All that depends on the stiffness does so through the
/// compliance, whose derivative is -compliance d_log_stiffness at any log_stiffness.
template <int N>
void set_section(const Rod& rod, const Section& section, const TipLoad& load, const LoadDirections<N>& d,
                 MarchField& field) {
  Vector3d compliance = Vector3d::Zero(), shear = Vector3d::Zero();
  if (!section.rigid) {
    compliance = compliance_factor(load).cwiseQuotient(section.stiffness_Nm2);
    if (rod.shears()) shear << 1.0 / rod.shear_stiffness_N, 1.0 / rod.shear_stiffness_N, 1.0 / rod.axial_stiffness_N;
  }
  const Vector3d tendon_curvature = compliance.cwiseProduct(load.tendon_couple_Nm);
  set(compliance, field.compliance_per_Nm2);
  set(shear, field.shear_compliance_per_N);
  set(unloaded_curvature(section, load) + tendon_curvature, field.free_curvature_per_m);
  Eigen::Matrix<double, 3, N> d_free = compliance.asDiagonal() * d.tendon_couple_Nm;
  d_free -= tendon_curvature.asDiagonal() * d.log_stiffness;
  if (!section.rigid) d_free += d.precurvature_per_m;
  set_columns<N>(d_free, field.d_free_curvature_per_m);
}

/// The unrotated tip.
template <int N>
void set_tip(MarchState& state) {
  for (Columns& row : state.rows)
    for (int j = 0; j < (N + kColumnStep) / kColumnStep * kColumnStep; ++j) row[j] = 0.0;
  state.rows[0][0] = 1.0;
}

/// R(q) of a state's value.
inline Matrix3d rotation(const MarchState& state) {
  return Eigen::Quaterniond(state.rows[0][0], state.rows[1][0], state.rows[2][0], state.rows[3][0]).toRotationMatrix();
}

/// Stores station values still relative to the tip frame; to_base_frame() finishes them.
template <int N>
void keep(const MarchState& state, const MarchRecord& record, bool full, const TipLoad& load,
          const LoadDirections<N>& d, int station, RodSolution<N>& solution) {
  RodPoint& point = solution.points[station];
  point.T_base_local = {rotation(state), value(state.rows + 4)};
  point.curvature_per_m = value(record.curvature_per_m);
  point.shear_strain = full ? value(record.strain) : Vector3d::Zero();
  point.force_local_N = value(record.force_N);
  point.moment_local_Nm = value(record.moment_Nm) + load.tendon_couple_Nm;
  if constexpr (N > 0) {
    RodPointTangent<N>& tangent = solution.tangents[station];
    tangent.rotation = columns<N>(state.rows + 1);
    tangent.position_m = columns<N>(state.rows + 4);
    tangent.curvature_per_m = columns<N>(record.curvature_per_m);
    if (full)
      tangent.shear_strain = columns<N>(record.strain);
    else
      tangent.shear_strain.setZero();
    tangent.force_local_N = columns<N>(record.force_N);
    tangent.moment_local_Nm = columns<N>(record.moment_Nm) + d.tendon_couple_Nm;
  }
}

/// Moves a station at the flexible end `beyond_m` onto the rigid tip, whose axes are the tip frame's.
template <int N>
void onto_rigid_tip(double beyond_m, const TipLoad& load, const LoadDirections<N>& d, int station,
                    RodSolution<N>& solution) {
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

/// T_base_local = T_tip_base^-1 T_tip_local, with `clamp` the state there.
template <int N>
void to_base_frame(const MarchState& clamp, RodSolution<N>& solution) {
  const Matrix3d R_base_tip = rotation(clamp).transpose();
  const Vector3d r_clamp = value(clamp.rows + 4);
  Eigen::Matrix<double, 3, N> clamp_rotation, clamp_position;
  if constexpr (N > 0) {
    clamp_rotation = columns<N>(clamp.rows + 1);
    clamp_position = columns<N>(clamp.rows + 4);
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

}  // namespace palpate::rod_lanes
