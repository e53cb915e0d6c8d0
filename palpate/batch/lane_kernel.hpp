// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/batch/kernel.hpp>
#include <palpate/rod/field.hpp>
#include <palpate/rod/runge_kutta.hpp>
#include <xsimd/xsimd.hpp>

/// A block of rods from the tip to the clamp, then all its points in the base frame: what RodSolver::solve does.
namespace palpate::rod_lanes {

/// Reads and writes the lanes [first, first + T::size) of rows.
template <class T>
struct Lanes {
  int first;

  T load(const Row& row) const { return T::load_unaligned(row + first); }
  Vec<T> load3(const Row* rows) const { return {load(rows[0]), load(rows[1]), load(rows[2])}; }
  void store(const T& x, Row& row) const { x.store_unaligned(row + first); }
  void store3(const Vec<T>& v, Row* rows) const { store(v.x, rows[0]), store(v.y, rows[1]), store(v.z, rows[2]); }
  /// Column j of a row-major 3 x 3 matrix.
  Vec<T> load_column(const Row* rows, int j) const { return {load(rows[j]), load(rows[3 + j]), load(rows[6 + j])}; }
  void store_column(const Vec<T>& v, Row* rows, int j) const {
    store(v.x, rows[j]), store(v.y, rows[3 + j]), store(v.z, rows[6 + j]);
  }
};

template <class T>
inline Vec<T> constant(const double* v) {
  return {T(v[0]), T(v[1]), T(v[2])};
}
template <class T>
inline Vec<T> zero() {
  return {T(0.0), T(0.0), T(0.0)};
}
template <class T>
inline Vec<T> axis(int j) {
  return {T(j == 0 ? 1.0 : 0.0), T(j == 1 ? 1.0 : 0.0), T(j == 2 ? 1.0 : 0.0)};
}

/// One piece of the rods in units of the step h.
template <class T>
struct Field {
  Parameters<T> value;
  TipDirection<T> along_force[3];
};

/// set_section() of rod/integration.hpp.
template <class T>
inline Field<T> field_of(const Plan& plan, const Piece& piece, const Loads& loads, const Lanes<T>& lanes, const T& h) {
  Vec<T> K = zero<T>(), u0 = constant<T>(piece.precurvature_per_m), shear = zero<T>();
  if (!piece.rigid) {
    const Vec<T> factor = lanes.load3(loads.compliance_factor), stiffness = constant<T>(piece.stiffness_Nm2);
    K = {factor.x / stiffness.x, factor.y / stiffness.y, factor.z / stiffness.z};
    u0 = u0 + lanes.load3(loads.precurvature_per_m);
    shear = (T(1.0) / h) * constant<T>(plan.shear_compliance);
  }
  Field<T> f;
  f.value.force = h * lanes.load3(loads.force_N);
  f.value.moment = lanes.load3(loads.moment_Nm);
  f.value.compliance = h * K;
  f.value.free_curvature = h * (u0 + K * lanes.load3(loads.couple_Nm));
  f.value.distributed = (h * h) * lanes.load3(loads.distributed_N_per_m);
  f.value.shear_compliance = shear;
  for (int j = 0; j < 3; ++j)
    f.along_force[j] = {h * axis<T>(j), cross(constant<T>(plan.contact_offset_m), axis<T>(j))};
  return f;
}

/// From the units of one piece to those of the next: s times `ratio`, z times its square.
template <bool Full, int Columns, class T>
inline void rescale(const T& ratio, T* y) {
  for (int c = 0; c < Columns; ++c)
    for (int i = 4; i < kRows<Full>; ++i) {
      T& x = y[c * kRows<Full> + i];
      x = (i < 7 ? ratio : ratio * ratio) * x;
    }
}

template <const auto& method, bool Full, int Columns, class T>
inline void step(const T& tau, const Field<T>& f, T* y) {
  constexpr int rows = kRows<Full>;
  const auto rates = [&f](const T& at_tau, const T* at, T* rate_at) {
    const Section<T> o = section<Full>(at_tau, at, f.value);
    rate<Full>(o, at, rate_at);
    for (int c = 1; c < Columns; ++c)
      rate_tangent<Full>(o, at_tau, at + c * rows, f.value, f.along_force[c - 1], rate_at + c * rows);
  };
  runge_kutta_step<method, rows, Columns>(tau, T(1.0), Columns, y, rates);
  normalise(y);
}

/// A step of the lanes in `mask`; the others keep their state.
template <const auto& method, bool Full, int Columns, class T, class Mask>
inline void masked_step(const T& tau, const Mask& mask, const Field<T>& f, T* y) {
  constexpr int size = kRows<Full> * Columns;
  T next[size];
  for (int c = 0; c < size; ++c) next[c] = y[c];
  step<method, Full, Columns>(tau, f, next);
  for (int c = 0; c < size; ++c) y[c] = select(mask, next[c], y[c]);
}

/// `steps` of each lane; negative: one of order 6.
template <bool Full, int Columns, class T>
inline void integrate(const T& from_tau, const T& steps, const Field<T>& f, T* y) {
  const auto is_short = steps < T(0.0);
  if (any(is_short)) masked_step<kButcher6, Full, Columns>(from_tau, is_short, f, y);
  for (double i = 0.0;; ++i) {
    const auto goes_on = T(i) < steps;
    if (!any(goes_on)) return;
    masked_step<kDormandPrince8, Full, Columns>(from_tau + T(i), goes_on, f, y);
  }
}

/// Stores a point still relative to the tip frame; to_base() finishes it.
template <bool Full, int Columns, class T>
inline void record(const T& tau, const T& h, const T* y, const Field<T>& f, const Lanes<T>& lanes, Point& point) {
  const Section<T> o = section<Full>(tau, y, f.value);
  const T per_m = T(1.0) / h, r_of_s = -h;
  lanes.store_column(o.R.d1, point.R, 0), lanes.store_column(o.R.d2, point.R, 1),
      lanes.store_column(o.R.d3, point.R, 2);
  lanes.store3(r_of_s * o.s, point.p_m);
  lanes.store3(per_m * o.curvature, point.curvature_per_m);
  for (int j = 0; j + 1 < Columns; ++j) {
    const T* column = y + (j + 1) * kRows<Full>;
    const TipDirection<T>& d = f.along_force[j];
    const Vec<T> phi = three(column, 1);
    const Vec<T> dm = to_local_tangent(o.R, o.m, phi, moment_tangent<Full>(o, tau, column, f.value, d));
    lanes.store_column(phi, point.d_rotation, j);
    lanes.store_column(r_of_s * three(column, 4), point.d_position_m, j);
    lanes.store_column(per_m * curvature_tangent(o, dm, f.value, d), point.d_curvature_per_m, j);
  }
}

/// Moves a point at the flexible end onto the rigid tip, whose axes are the tip frame's and which does not bend.
template <class T>
inline void onto_rigid_tip(double beyond_m, const Lanes<T>& lanes, Point& point) {
  const T zero(0.0);
  lanes.store(T(beyond_m), point.p_m[2]);
  for (Row& row : point.curvature_per_m) lanes.store(zero, row);
  for (Row& row : point.d_curvature_per_m) lanes.store(zero, row);
}

/// T_base_local = T_tip_base^-1 T_tip_local, with `y` the state at the clamp, its rows 4 to 6 being r in metres.
template <bool Full, int Columns, class T>
inline void to_base(const T* y, const Lanes<T>& lanes, Point& point) {
  const Rotation<T> clamp_axes = rotation(y[0], three(y, 1));
  const auto to_base_axes = [&](const Vec<T>& x) { return to_local(clamp_axes, x); };
  Vec<T> R[3];
  for (int j = 0; j < 3; ++j) {
    R[j] = to_base_axes(lanes.load_column(point.R, j));
    lanes.store_column(R[j], point.R, j);
  }
  const Vec<T> position = to_base_axes(lanes.load3(point.p_m) - three(y, 4));
  lanes.store3(position, point.p_m);
  for (int j = 0; j + 1 < Columns; ++j) {
    const T* column = y + (j + 1) * kRows<Full>;
    const Vec<T> clamp = three(column, 1);
    const Vec<T> local{dot(R[0], clamp), dot(R[1], clamp), dot(R[2], clamp)};
    lanes.store_column(lanes.load_column(point.d_rotation, j) - local, point.d_rotation, j);
    const Vec<T> moved = to_base_axes(lanes.load_column(point.d_position_m, j) - three(column, 4));
    lanes.store_column(moved + cross(position, clamp), point.d_position_m, j);
  }
}

template <bool Full, int Columns, class T>
inline void solve_lanes(const Plan& plan, const Loads& loads, const Row* steps, const Lanes<T>& lanes, Point* points) {
  T y[kRows<Full> * Columns];
  for (T& x : y) x = T(0.0);
  y[0] = T(1.0);
  T previous_h(1.0);
  for (int i = 0; i < plan.piece_count; ++i) {
    const Piece& piece = plan.pieces[i];
    const T counts = lanes.load(steps[i]), n = abs(counts), h = T(piece.length_m) / n,
            from_tau = T(piece.from_sigma_m) / h;
    const Field<T> f = field_of(plan, piece, loads, lanes, h);
    rescale<Full, Columns>(previous_h / h, y);
    if (i == 0)
      for (int k = 0; k < plan.points_at_tip; ++k) {
        record<Full, Columns>(T(0.0), h, y, f, lanes, points[k]);
        if (plan.beyond_m[k] > 0.0) onto_rigid_tip(plan.beyond_m[k], lanes, points[k]);
      }
    integrate<Full, Columns>(from_tau, counts, f, y);
    for (int k = piece.first_point; k < piece.end_point; ++k)
      record<Full, Columns>(from_tau + n, h, y, f, lanes, points[k]);
    previous_h = h;
  }
  rescale<Full, Columns>(-previous_h, y);
  for (int k = 0; k < plan.point_count; ++k) to_base<Full, Columns>(y, lanes, points[k]);
}

template <bool Full, int Columns, class T>
inline void solve_rows(const Plan& plan, const Loads& loads, const Row* steps, int lanes, Point* points) {
  for (int first = 0; first < lanes; first += static_cast<int>(T::size))
    solve_lanes<Full, Columns, T>(plan, loads, steps, {first}, points);
}

template <class T>
inline void solve(const Plan& plan, Kind kind, const Loads& loads, const Row* steps, int lanes, Point* points) {
  if (kind.full)
    kind.sensitivities ? solve_rows<true, 4, T>(plan, loads, steps, lanes, points)
                       : solve_rows<true, 1, T>(plan, loads, steps, lanes, points);
  else
    kind.sensitivities ? solve_rows<false, 4, T>(plan, loads, steps, lanes, points)
                       : solve_rows<false, 1, T>(plan, loads, steps, lanes, points);
}

}  // namespace palpate::rod_lanes
