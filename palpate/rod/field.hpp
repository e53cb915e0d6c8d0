// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

/// Right-hand side of the rod's initial-value problem, in the tip frame, and its exact tangent. Written once over the
/// scalar type T: double, a wider float for checks, or a SIMD batch. N tangent columns ride beside the value.
///
///   origin at the tip, components in the tip frame, sigma = L - s runs from the tip to the clamp
///   n   = F + sigma g                                 force across the section        (3), integrated
///   mu  = M - r x n + rho x g                         moment, a first integral of (3); rho = int_s^L r ds
///   u   = u0 + K^-1 (m_t + R^T mu)                    Darboux vector                   (4)
///   v   = e3 + Kse^-1 R^T n                           e3 for a Kirchhoff rod
///   dq/dsigma = -q u / 2,  dr/dsigma = -R v,  drho/dsigma = r                          (1), (2)
///
/// q = (w, a) is the rotation R(s) = R_tip_local(s). The field is polynomial in q; the unit norm is restored after each
/// step, so R is a rotation at every node to rounding.
namespace palpate::rod_field {

template <class T>
using Vec3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Mat3 = Eigen::Matrix<T, 3, 3>;
/// Row-major, so that the compiler's vector lanes run across the columns.
template <class T, int N>
using Cols = Eigen::Matrix<T, 3, N, (N > 1 ? Eigen::RowMajor : Eigen::ColMajor)>;

/// Rows of the state: w, a (3), r (3), rho (3). Column 0 is the value, columns 1..N its tangents.
/// The Kirchhoff rod without distributed load drops rho.
template <class T, int N, bool Full>
using State = Eigen::Matrix<T, Full ? 10 : 7, N + 1, (N > 0 ? Eigen::RowMajor : Eigen::ColMajor)>;

/// What one section and one load give the field.
template <class T, int N>
struct Parameters {
  Vec3<T> force, moment;     ///< F, M: tip components, at the flexible end
  Vec3<T> distributed;       ///< g: uniform load, tip components
  Vec3<T> compliance;        ///< diagonal of K^-1; zero in a rigid section
  Vec3<T> free_curvature;    ///< u0 + K^-1 m_t
  Vec3<T> shear_compliance;  ///< diagonal of Kse^-1; zero: no shear, no stretch
  Cols<T, N> d_force, d_moment, d_distributed, d_log_stiffness, d_free_curvature;
};

/// a x B, column by column.
template <class T, class B>
inline auto cross(const Vec3<T>& a, const B& b) {
  Cols<T, B::ColsAtCompileTime> c;
  c.row(0) = a(1) * b.row(2) - a(2) * b.row(1);
  c.row(1) = a(2) * b.row(0) - a(0) * b.row(2);
  c.row(2) = a(0) * b.row(1) - a(1) * b.row(0);
  return c;
}

/// R = I + 2 w hat(a) + 2 hat(a)^2, kept polynomial off the unit sphere.
template <class T>
inline Mat3<T> rotation(const T& w, const Vec3<T>& a) {
  const T two = T(2);
  const T xx = a(0) * a(0), yy = a(1) * a(1), zz = a(2) * a(2);
  const T xy = a(0) * a(1), xz = a(0) * a(2), yz = a(1) * a(2);
  Mat3<T> R;
  R(0, 0) = T(1) - two * (yy + zz), R(0, 1) = two * (xy - w * a(2)), R(0, 2) = two * (xz + w * a(1));
  R(1, 0) = two * (xy + w * a(2)), R(1, 1) = T(1) - two * (xx + zz), R(1, 2) = two * (yz - w * a(0));
  R(2, 0) = two * (xz - w * a(1)), R(2, 1) = two * (yz + w * a(0)), R(2, 2) = T(1) - two * (xx + yy);
  return R;
}

/// Tangent of R(q) x for a fixed x, with t = x x delta a:  2 c delta w - 2 w t - 2 c x delta a - 2 a x t,  c = a x x.
/// `sign` = -1 turns it into that of R(q)^T x.
template <class T, class DW, class DA>
inline auto rotated_tangent(const T& w, const Vec3<T>& a, const Vec3<T>& x, const DW& d_w, const DA& d_a, T sign) {
  const Vec3<T> c = a.cross(x);
  const auto t = cross<T>(x, d_a);
  Cols<T, DA::ColsAtCompileTime> d = cross<T>(c, d_a);
  d += cross<T>(a, t);
  for (int i = 0; i < 3; ++i) d.row(i) = T(2) * (sign * (c(i) * d_w - w * t.row(i)) - d.row(i));
  return d;
}

/// B = A^T X without Eigen's general product.
template <class T, class X>
inline auto transpose_times(const Mat3<T>& A, const X& x) {
  Cols<T, X::ColsAtCompileTime> b;
  for (int i = 0; i < 3; ++i) b.row(i) = A(0, i) * x.row(0) + A(1, i) * x.row(1) + A(2, i) * x.row(2);
  return b;
}

/// Everything about one section that outputs and field share.
template <class T, int N>
struct Section {
  Vec3<T> n, mu, elastic_curvature, u, shear;  ///< tip components: n, mu; local: K^-1 R^T mu, u, v - e3
  Cols<T, N> d_n, d_mu, d_u, d_shear;
  Mat3<T> R;
};

template <bool Full, class T, int N>
inline Section<T, N> section(const T& sigma, const State<T, N, Full>& y, const Parameters<T, N>& p) {
  Section<T, N> o;
  const T w = y(0, 0);
  const Vec3<T> a = y.template block<3, 1>(1, 0), r = y.template block<3, 1>(4, 0);
  o.R = rotation(w, a);
  o.n = p.force;
  if constexpr (Full) o.n += sigma * p.distributed;
  o.mu = p.moment - r.cross(o.n);
  if constexpr (Full) o.mu += Vec3<T>(y.template block<3, 1>(7, 0)).cross(p.distributed);
  o.elastic_curvature = p.compliance.cwiseProduct(o.R.transpose() * o.mu);
  o.u = p.free_curvature + o.elastic_curvature;
  if constexpr (Full) o.shear = p.shear_compliance.cwiseProduct(o.R.transpose() * o.n);

  if constexpr (N > 0) {
    const auto d_w = y.template block<1, N>(0, 1);
    const Cols<T, N> d_a = y.template block<3, N>(1, 1), d_r = y.template block<3, N>(4, 1);
    o.d_n = p.d_force;
    if constexpr (Full) o.d_n += sigma * p.d_distributed;
    o.d_mu = p.d_moment + cross<T>(o.n, d_r) - cross<T>(r, o.d_n);
    if constexpr (Full) {
      const Vec3<T> rho = y.template block<3, 1>(7, 0);
      const Cols<T, N> d_rho = y.template block<3, N>(7, 1);
      o.d_mu += cross<T>(rho, p.d_distributed) - cross<T>(p.distributed, d_rho);
    }
    Cols<T, N> d_m = transpose_times<T>(o.R, o.d_mu);
    d_m += rotated_tangent<T>(w, a, o.mu, d_w, d_a, T(-1));
    for (int i = 0; i < 3; ++i)
      o.d_u.row(i) =
          p.d_free_curvature.row(i) + p.compliance(i) * d_m.row(i) - o.elastic_curvature(i) * p.d_log_stiffness.row(i);
    if constexpr (Full) {
      Cols<T, N> d_nb = transpose_times<T>(o.R, o.d_n);
      d_nb += rotated_tangent<T>(w, a, o.n, d_w, d_a, T(-1));
      for (int i = 0; i < 3; ++i) o.d_shear.row(i) = p.shear_compliance(i) * d_nb.row(i);
    }
  }
  return o;
}

/// d state / d sigma, value and tangents.
template <bool Full, class T, int N>
inline void derivative(const T& sigma, const State<T, N, Full>& y, const Parameters<T, N>& p, State<T, N, Full>& dy) {
  const Section<T, N> o = section<Full>(sigma, y, p);
  const T w = y(0, 0);
  const Vec3<T> a = y.template block<3, 1>(1, 0);
  Vec3<T> v = Vec3<T>::UnitZ();
  if constexpr (Full) v += o.shear;

  dy(0, 0) = T(0.5) * (a(0) * o.u(0) + a(1) * o.u(1) + a(2) * o.u(2));
  dy.template block<3, 1>(1, 0) = T(-0.5) * (w * o.u + a.cross(o.u));
  dy.template block<3, 1>(4, 0) = -(o.R * v);
  if constexpr (Full) dy.template block<3, 1>(7, 0) = y.template block<3, 1>(4, 0);

  if constexpr (N > 0) {
    const auto d_w = y.template block<1, N>(0, 1);
    const Cols<T, N> d_a = y.template block<3, N>(1, 1);
    dy.template block<1, N>(0, 1) = T(0.5) * (o.u(0) * d_a.row(0) + o.u(1) * d_a.row(1) + o.u(2) * d_a.row(2) +
                                              a(0) * o.d_u.row(0) + a(1) * o.d_u.row(1) + a(2) * o.d_u.row(2));
    const Cols<T, N> turn = cross<T>(a, o.d_u) - cross<T>(o.u, d_a);
    for (int i = 0; i < 3; ++i)
      dy.template block<1, N>(1 + i, 1) = T(-0.5) * (o.u(i) * d_w + w * o.d_u.row(i) + turn.row(i));
    dy.template block<3, N>(4, 1) = -rotated_tangent<T>(w, a, v, d_w, d_a, T(1));
    if constexpr (Full) {
      dy.template block<3, N>(4, 1) -= transpose_times<T>(o.R.transpose(), o.d_shear);
      dy.template block<3, N>(7, 1) = y.template block<3, N>(4, 1);
    }
  }
}

/// Puts q back on the unit sphere, tangents onto its tangent plane.
template <bool Full, class T, int N>
inline void normalise(State<T, N, Full>& y) {
  using std::sqrt;
  const T w = y(0, 0), a0 = y(1, 0), a1 = y(2, 0), a2 = y(3, 0);
  const T scale = T(1) / sqrt(w * w + a0 * a0 + a1 * a1 + a2 * a2);
  y.template topRows<4>() *= scale;
  if constexpr (N > 0) {
    const Eigen::Matrix<T, 4, 1> q = y.template block<4, 1>(0, 0);
    const Eigen::Matrix<T, 1, N> along = q.transpose() * y.template block<4, N>(0, 1);
    y.template block<4, N>(0, 1) -= q * along;
  }
}

/// Body-side rotation tangent phi of R(q): delta R = R hat(phi), phi = 2 Im(conj(q) delta q).
template <bool Full, class T, int N>
inline Cols<T, N> rotation_tangent(const State<T, N, Full>& y) {
  const T w = y(0, 0);
  const Vec3<T> a = y.template block<3, 1>(1, 0);
  const auto d_w = y.template block<1, N>(0, 1);
  const auto d_a = y.template block<3, N>(1, 1);
  return T(2) * (w * d_a - a * d_w - cross<T>(a, Cols<T, N>(d_a)));
}

}  // namespace palpate::rod_field
