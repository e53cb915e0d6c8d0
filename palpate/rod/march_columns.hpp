// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/rod/field.hpp>
#include <palpate/rod/march.hpp>
#include <utility>
#include <xsimd/xsimd.hpp>

/// Between the columns of march.hpp, in metres, and vectors T in units of the step.
namespace palpate::rod_lanes {

template <class T>
[[gnu::always_inline]] inline T load(const Columns& row, int vector) {
  return T::load_unaligned(row + vector * static_cast<int>(T::size));
}
template <class T>
[[gnu::always_inline]] inline Vec<T> load3(const T& scale, const Columns* rows, int vector) {
  return {scale * load<T>(rows[0], vector), scale * load<T>(rows[1], vector), scale * load<T>(rows[2], vector)};
}
template <class T>
[[gnu::always_inline]] inline void store3(const Vec<T>& v, Columns* rows, int vector) {
  const int first = vector * static_cast<int>(T::size);
  v.x.store_unaligned(rows[0] + first), v.y.store_unaligned(rows[1] + first), v.z.store_unaligned(rows[2] + first);
}
template <class T>
[[gnu::always_inline]] inline Vec<T> spread(const T& scale, const double* v) {
  return {scale * T(v[0]), scale * T(v[1]), scale * T(v[2])};
}

/// `value` in the first lane, `tangent` in the others: the choice is part of the instruction.
template <class T, std::size_t... Lane>
[[gnu::always_inline]] inline T join(const T& value, const T& tangent, std::index_sequence<Lane...>) {
  return select(xsimd::batch_bool_constant<T, (Lane == 0)...>(), value, tangent);
}
template <class T>
[[gnu::always_inline]] inline T join(const T& value, const T& tangent) {
  return join(value, tangent, std::make_index_sequence<T::size>());
}
template <class T>
[[gnu::always_inline]] inline Vec<T> join(const Vec<T>& value, const Vec<T>& tangent) {
  return {join(value.x, tangent.x), join(value.y, tangent.y), join(value.z, tangent.z)};
}

template <class T>
[[gnu::always_inline]] inline Parameters<T> parameters_in_steps(const MarchField& f, const T& h) {
  Parameters<T> p;
  const T one(1.0);
  p.force = spread(h, f.force_N);
  p.moment = spread(one, f.moment_Nm);
  p.compliance = spread(h, f.compliance_per_Nm2);
  p.free_curvature = spread(h, f.free_curvature_per_m);
  p.distributed = spread(h * h, f.distributed_N_per_m);
  p.shear_compliance = spread(one / h, f.shear_compliance_per_N);
  return p;
}
template <class T>
[[gnu::always_inline]] inline Direction<T> direction_in_steps(const MarchField& f, const T& h, int vector) {
  Direction<T> d;
  const T one(1.0);
  d.force = load3(h, f.d_force_N, vector);
  d.moment = load3(one, f.d_moment_Nm, vector);
  d.distributed = load3(h * h, f.d_distributed_N_per_m, vector);
  d.log_stiffness = load3(one, f.d_log_stiffness, vector);
  d.free_curvature = load3(h, f.d_free_curvature_per_m, vector);
  return d;
}

/// s = -r / h, z = -rho / h^2, and back.
template <bool Full, class T>
[[gnu::always_inline]] inline void to_steps(double h, T* y) {
  const T r(-1.0 / h), rho(-1.0 / (h * h));
  for (int i = 4; i < kRows<Full>; ++i) y[i] = (i < 7 ? r : rho) * y[i];
}
template <bool Full, class T>
[[gnu::always_inline]] inline void from_steps(double h, T* y) {
  const T r(-h), rho(-h * h);
  for (int i = 4; i < kRows<Full>; ++i) y[i] = (i < 7 ? r : rho) * y[i];
}

}  // namespace palpate::rod_lanes
