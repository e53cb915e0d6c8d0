// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <palpate/rod/lanes.hpp>

/// Right-hand side of the rod's initial-value problem, in the tip frame, and its variation. Written once over T: a SIMD
/// batch, in which the lanes are rods (batch) or directions (march), or a plain number, double or wider.
///
///   origin at the tip, components in the tip frame, sigma = L - s runs from the tip to the clamp
///   n   = F + sigma g                                 force across the section        (3), integrated
///   mu  = M - r x n + rho x g                         moment, a first integral of (3); rho = int_s^L r ds
///   u   = u0 + K^-1 (m_t + R^T mu)                    Darboux vector                   (4)
///   v   = e3 + Kse^-1 R^T n                           e3 for a Kirchhoff rod
///   dq/dsigma = -q u / 2,  dr/dsigma = -R v,  drho/dsigma = r                          (2), (1)
///
/// q = (w, a) is the rotation R(s) = R_tip_local(s). Its unit norm is restored after each step, so R is a rotation at
/// every node to rounding. Along a direction, with delta R = R hat(phi), six numbers (nine) vary:
///
///   dphi/dsigma = u x phi - du,   d(dr)/dsigma = -R (phi x v + dv),   d(R^T x) = R^T dx + (R^T x) x phi
///
/// All in units in which a step is 1 long and signs vanish:
///
///   s = -r / h, z = -rho / h^2, n' = h n, g' = h^2 g, tau = sigma / h, u' = h u, c' = h K^-1
namespace palpate::rod_lanes {

/// Numbers of a state: w, a (3), s (3), and z (3) where the field is full: with shear or a distributed load. Of a
/// tangent: nothing, phi (3), ds (3), dz (3).
template <bool Full>
inline constexpr int kRows = Full ? 10 : 7;

/// What one section and one load give the field. The last two are read by the full field only.
template <class T>
struct Parameters {
  Vec<T> force, moment;                  ///< h F, M: at the flexible end
  Vec<T> compliance, free_curvature;     ///< c', h (u0 + K^-1 m_t)
  Vec<T> distributed, shear_compliance;  ///< g', Kse^-1 / h; zero: no shear, no stretch
};

/// Derivatives of the parameters along one direction, of the tip's load alone.
template <class T>
struct TipDirection {
  Vec<T> force, moment;
};

/// Along any direction: of the shaft's shape and stiffness as well.
template <class T>
struct Direction : TipDirection<T> {
  Vec<T> distributed, log_stiffness, free_curvature;
};

/// R, column by column.
template <class T>
struct Rotation {
  Vec<T> d1, d2, d3;
};

/// R = I + 2 w hat(a) + 2 hat(a)^2, kept polynomial off the unit sphere.
template <class T>
[[gnu::always_inline]] inline Rotation<T> rotation(const T& w, const Vec<T>& a) {
  const T one(1.0);
  const Vec<T> b = a + a;
  return {{one - a.y * b.y - a.z * b.z, a.x * b.y + w * b.z, a.x * b.z - w * b.y},
          {a.x * b.y - w * b.z, one - a.x * b.x - a.z * b.z, a.y * b.z + w * b.x},
          {a.x * b.z + w * b.y, a.y * b.z - w * b.x, one - a.x * b.x - a.y * b.y}};
}

/// R x.
template <class T>
[[gnu::always_inline]] inline Vec<T> operator*(const Rotation<T>& R, const Vec<T>& x) {
  return plus(plus(x.x * R.d1, x.y, R.d2), x.z, R.d3);
}
/// R^T x, and its derivative along phi and dx; `m` = R^T x.
template <class T>
[[gnu::always_inline]] inline Vec<T> to_local(const Rotation<T>& R, const Vec<T>& x) {
  return {dot(R.d1, x), dot(R.d2, x), dot(R.d3, x)};
}
template <class T>
[[gnu::always_inline]] inline Vec<T> to_local_tangent(const Rotation<T>& R, const Vec<T>& m, const Vec<T>& phi,
                                                      const Vec<T>& dx) {
  return plus_cross(to_local(R, dx), m, phi);
}

/// What value and tangents of one section share.
template <class T>
struct Section {
  Rotation<T> R;
  Vec<T> s, n, m;                       ///< s, n' in tip components; m = R^T mu
  Vec<T> elastic_curvature, curvature;  ///< c' m, u'
  Vec<T> z, n_local, v;                 ///< of the full field
};

template <bool Full, class T>
[[gnu::always_inline]] inline Section<T> section(const T& tau, const T* y, const Parameters<T>& p) {
  Section<T> o;
  o.R = rotation(y[0], three(y, 1));
  o.s = three(y, 4), o.n = p.force;
  if constexpr (Full) o.n = plus(o.n, tau, p.distributed);
  Vec<T> mu = plus_cross(p.moment, o.s, o.n);
  if constexpr (Full) o.z = three(y, 7), mu = plus_cross(mu, p.distributed, o.z);
  o.m = to_local(o.R, mu);
  o.elastic_curvature = p.compliance * o.m;
  o.curvature = p.free_curvature + o.elastic_curvature;
  if constexpr (Full) {
    o.n_local = to_local(o.R, o.n);
    o.v = p.shear_compliance * o.n_local;
    o.v.z = o.v.z + T(1.0);
  }
  return o;
}

/// n' and mu along a direction; `y` is that column of the state.
template <bool Full, class T, class Along>
[[gnu::always_inline]] inline Vec<T> force_tangent(const T& tau, const Along& d) {
  if constexpr (Full && requires { d.distributed; }) return plus(d.force, tau, d.distributed);
  return d.force;
}
template <bool Full, class T, class Along>
[[gnu::always_inline]] inline Vec<T> moment_tangent(const Section<T>& o, const T& tau, const T* y,
                                                    const Parameters<T>& p, const Along& d) {
  Vec<T> d_mu = plus_cross(plus_cross(d.moment, three(y, 4), o.n), o.s, force_tangent<Full>(tau, d));
  if constexpr (Full) d_mu = plus_cross(d_mu, p.distributed, three(y, 7));
  if constexpr (Full && requires { d.distributed; }) d_mu = plus_cross(d_mu, d.distributed, o.z);
  return d_mu;
}

/// u' along a direction in which m changes by `dm`.
template <class T, class Along>
[[gnu::always_inline]] inline Vec<T> curvature_tangent(const Section<T>& o, const Vec<T>& dm, const Parameters<T>& p,
                                                       const Along& d) {
  if constexpr (requires { d.free_curvature; })
    return plus(minus(d.free_curvature, o.elastic_curvature, d.log_stiffness), p.compliance, dm);
  else
    return p.compliance * dm;
}

/// v along a direction.
template <class T, class Along>
[[gnu::always_inline]] inline Vec<T> strain_tangent(const Section<T>& o, const T& tau, const Vec<T>& phi,
                                                    const Parameters<T>& p, const Along& d) {
  return p.shear_compliance * to_local_tangent(o.R, o.n_local, phi, force_tangent<true>(tau, d));
}

/// d state / d tau:  dw = a.u' / 2,  da = (u' x a - w u') / 2,  ds = R v,  dz = s.
template <bool Full, class T>
[[gnu::always_inline]] inline void rate(const Section<T>& o, const T* y, T* dy) {
  const Vec<T> a = three(y, 1), half = T(0.5) * o.curvature;
  dy[0] = dot(a, half);
  put(minus(cross(half, a), y[0], half), dy, 1);
  if constexpr (Full) {
    put(o.R * o.v, dy, 4);
    put(o.s, dy, 7);
  } else {
    put(o.R.d3, dy, 4);
  }
}

/// d column / d tau along a direction.
template <bool Full, class T, class Along>
[[gnu::always_inline]] inline void rate_tangent(const Section<T>& o, const T& tau, const T* y, const Parameters<T>& p,
                                                const Along& d, T* dy) {
  const Vec<T> phi = three(y, 1);
  const Vec<T> dm = to_local_tangent(o.R, o.m, phi, moment_tangent<Full>(o, tau, y, p, d));
  dy[0] = T(0.0);
  put(cross(o.curvature, phi) - curvature_tangent(o, dm, p, d), dy, 1);
  if constexpr (Full) {
    put(o.R * plus_cross(strain_tangent(o, tau, phi, p, d), phi, o.v), dy, 4);
    put(three(y, 4), dy, 7);
  } else {
    put(minus(phi.y * o.R.d1, phi.x, o.R.d2), dy, 4);
  }
}

/// Puts q back on the unit sphere.
template <class T>
[[gnu::always_inline]] inline void normalise(T* q) {
  using std::sqrt;
  const T scale = T(1.0) / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int i = 0; i < 4; ++i) q[i] = scale * q[i];
}

}  // namespace palpate::rod_lanes
