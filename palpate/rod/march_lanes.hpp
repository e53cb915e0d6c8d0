// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/rod/march_columns.hpp>
#include <palpate/rod/runge_kutta.hpp>

/// The kernel behind MarchKernel: columns ride in the lanes of vectors T, the value in the first lane of the first. The
/// value's share of the field is computed in all lanes alike, which costs no more than in one.
namespace palpate::rod_lanes {

/// u, in 1/m. Without a load it is u0 to the last bit.
template <class T>
[[gnu::always_inline]] inline Vec<T> curvature(const Section<T>& o, double h, const MarchField& field) {
  return plus(spread(T(1.0), field.free_curvature_per_m), T(1.0 / h), o.elastic_curvature);
}

/// A piece in units of its step. The value alone, in all lanes alike.
template <bool Full, class T>
class ValueMarch {
 public:
  static constexpr int kSize = kRows<Full>;

  [[gnu::always_inline]] ValueMarch(const MarchPiece& piece, const MarchField& field)
      : h_(piece.length_m / piece.steps.count),
        from_tau_(piece.from_sigma_m / h_),
        p_(parameters_in_steps(field, T(h_))) {}

  [[gnu::always_inline]] void load(const MarchState& state) {
    for (int i = 0; i < kSize; ++i) y_[i] = T(state.rows[i][0]);
    to_steps<Full>(h_, y_);
  }
  [[gnu::always_inline]] void store(MarchState& state) {
    from_steps<Full>(h_, y_);
    for (int i = 0; i < kSize; ++i) state.rows[i][0] = y_[i].get(0);
  }

  template <const auto& method>
  [[gnu::always_inline]] void step(int i) {
    const auto field = [this](const T& tau, const T* y, T* dy) __attribute__((always_inline)) {
      rate<Full>(section<Full>(tau, y, p_), y, dy);
    };
    runge_kutta_step<method, kSize, 1>(T(from_tau_ + i), T(1.0), 1, y_, field);
    normalise(y_);
  }

  [[gnu::always_inline]] void record(int steps, const MarchField& field, MarchRecord& out) const {
    const Section<T> o = section<Full>(T(from_tau_ + steps), y_, p_);
    put_value(curvature(o, h_, field), out.curvature_per_m);
    put_value(T(1.0 / h_) * to_local(o.R, o.n), out.force_N);
    put_value(o.m, out.moment_Nm);
    if constexpr (Full) put_value({o.v.x, o.v.y, o.v.z - T(1.0)}, out.strain);
  }

 private:
  [[gnu::always_inline]] static void put_value(const Vec<T>& v, Columns* rows) {
    rows[0][0] = v.x.get(0), rows[1][0] = v.y.get(0), rows[2][0] = v.z.get(0);
  }

  double h_, from_tau_;
  Parameters<T> p_;
  T y_[kSize];
};

/// Value and tangents, `Most` vectors at most.
template <bool Full, int Most, class T>
class TangentMarch {
 public:
  static constexpr int kSize = kRows<Full>;

  [[gnu::always_inline]] TangentMarch(const MarchPiece& piece, const MarchField& field, int vectors)
      : h_(piece.length_m / piece.steps.count),
        from_tau_(piece.from_sigma_m / h_),
        vectors_(vectors),
        p_(parameters_in_steps(field, T(h_))) {
    for (int v = 0; v < count(); ++v) d_[v] = direction_in_steps(field, T(h_), v);
  }

  [[gnu::always_inline]] void load(const MarchState& state) {
    for (int v = 0; v < count(); ++v) {
      for (int i = 0; i < kSize; ++i) y_[v * kSize + i] = rod_lanes::load<T>(state.rows[i], v);
      to_steps<Full>(h_, y_ + v * kSize);
    }
  }
  [[gnu::always_inline]] void store(MarchState& state) {
    for (int v = 0; v < count(); ++v) {
      from_steps<Full>(h_, y_ + v * kSize);
      for (int i = 0; i < kSize; ++i) y_[v * kSize + i].store_unaligned(state.rows[i] + v * static_cast<int>(T::size));
    }
  }

  template <const auto& method>
  [[gnu::always_inline]] void step(int i) {
    const auto field = [this](const T& tau, const T* y, T* dy) __attribute__((always_inline)) { rates(tau, y, dy); };
    runge_kutta_step<method, kSize, Most>(T(from_tau_ + i), T(1.0), count(), y_, field);
    normalise_value();
  }

  [[gnu::always_inline]] void record(int steps, const MarchField& field, MarchRecord& out) const {
    const T tau(from_tau_ + steps), per_h(1.0 / h_);
    T value[kSize];
    spread_value(y_, value);
    const Section<T> o = section<Full>(tau, value, p_);
    const Vec<T> n = to_local(o.R, o.n);
    for (int v = 0; v < count(); ++v) {
      const T* y = y_ + v * kSize;
      const Vec<T> phi = three(y, 1);
      Vec<T> dm = to_local_tangent(o.R, o.m, phi, moment_tangent<Full>(o, tau, y, p_, d_[v]));
      Vec<T> dn = to_local_tangent(o.R, n, phi, force_tangent<Full>(tau, d_[v]));
      Vec<T> du = per_h * curvature_tangent(o, dm, p_, d_[v]);
      if (v == 0) dm = join(o.m, dm), dn = join(n, dn), du = join(curvature(o, h_, field), du);
      store3(du, out.curvature_per_m, v);
      store3(per_h * dn, out.force_N, v);
      store3(dm, out.moment_Nm, v);
      if constexpr (Full) {
        const Vec<T> dv = strain_tangent(o, tau, phi, p_, d_[v]);
        store3(v == 0 ? join(Vec<T>{o.v.x, o.v.y, o.v.z - T(1.0)}, dv) : dv, out.strain, v);
      }
    }
  }

 private:
  [[gnu::always_inline]] int count() const {
    if constexpr (Most == 1) return 1;
    return vectors_;
  }

  [[gnu::always_inline]] static void spread_value(const T* y, T* value) {
    for (int i = 0; i < kSize; ++i) value[i] = T(y[i].get(0));
  }

  [[gnu::always_inline]] void rates(const T& tau, const T* y, T* dy) const {
    T value[kSize], value_rate[kSize];
    spread_value(y, value);
    const Section<T> o = section<Full>(tau, value, p_);
    rate<Full>(o, value, value_rate);
    rate_tangent<Full>(o, tau, y, p_, d_[0], dy);
    for (int i = 0; i < kSize; ++i) dy[i] = join(value_rate[i], dy[i]);
    if constexpr (Most > 1)
      for (int v = 1; v < count(); ++v) rate_tangent<Full>(o, tau, y + v * kSize, p_, d_[v], dy + v * kSize);
  }

  /// The tangents are the rotation's own: nothing of them is off the sphere.
  [[gnu::always_inline]] void normalise_value() {
    T q[4];
    for (int i = 0; i < 4; ++i) q[i] = T(y_[i].get(0));
    normalise(q);
    for (int i = 0; i < 4; ++i) y_[i] = join(q[i], y_[i]);
  }

  double h_, from_tau_;
  int vectors_;
  Parameters<T> p_;
  Direction<T> d_[Most];
  T y_[Most * kSize];
};

template <class March>
[[gnu::always_inline]] inline void run(March&& march, const MarchPiece& piece, const MarchField& field,
                                       MarchState& state, MarchRecord* before, MarchRecord* after) {
  march.load(state);
  if (before != nullptr) march.record(0, field, *before);
  if (piece.steps.sixth_order)
    march.template step<kButcher6>(0);
  else
    for (int i = 0; i < piece.steps.count; ++i) march.template step<kDormandPrince8>(i);
  if (after != nullptr) march.record(piece.steps.count, field, *after);
  march.store(state);
}

/// Few columns in one narrow vector, many in several wide ones.
template <bool Full, class Narrow, class Wide>
void march(const MarchPiece& piece, int columns, const MarchField& field, MarchState& state, MarchRecord* before,
           MarchRecord* after) {
  constexpr int narrow = static_cast<int>(Narrow::size), wide = static_cast<int>(Wide::size);
  const int vectors = (columns + wide - 1) / wide;
  if (columns == 1)
    run(ValueMarch<Full, Narrow>(piece, field), piece, field, state, before, after);
  else if (columns <= narrow)
    run(TangentMarch<Full, 1, Narrow>(piece, field, 1), piece, field, state, before, after);
  else
    run(TangentMarch<Full, kMostColumns / wide, Wide>(piece, field, vectors), piece, field, state, before, after);
}

}  // namespace palpate::rod_lanes
