// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

/// The rod written a second time, for tests only, along another road than palpate/rod/field.hpp: balance in local
/// components as in the paper, direction cosines instead of a quaternion, classic Runge-Kutta, long double.
///
///   n' + u x n + R^T w = 0                                              (5), and w, a uniform load
///   m' + u x m + v x n = 0,   u = u0 + K^-1 (m_t + m)                   (6): with m = K (u - u0), component by
///   component v = e3 + Kse^-1 n,   R' = R hat(u),   r' = R v                      (2), (1)
///
/// from the tip (R = I, r = 0, n = F, m = M, w in tip components) to the clamp.
namespace palpate::test::body_frame {

using Real = long double;
using Vec = Eigen::Matrix<Real, 3, 1>;
using Mat = Eigen::Matrix<Real, 3, 3>;

struct Inputs {
  Real length = 0;
  Vec F = Vec::Zero(), M = Vec::Zero(), tendon = Vec::Zero(), log_stiffness = Vec::Zero(), u0 = Vec::Zero(),
      w = Vec::Zero(), shear_compliance = Vec::Zero();
};

struct Point {
  Mat R;
  Vec r, u, shear, n, m;
};

struct State {
  Mat R;
  Vec r, n, m;
  State plus(Real h, const State& d) const { return {R + h * d.R, r + h * d.r, n + h * d.n, m + h * d.m}; }
};

inline Vec stiffness(const Inputs& in) { return in.log_stiffness.array().exp().matrix(); }

inline Vec curvature(const Inputs& in, const Vec& K, const State& y) {
  return in.u0 + (in.tendon + y.m).cwiseQuotient(K);
}

inline State rate(const Inputs& in, const Vec& K, const State& y) {
  const Vec u = curvature(in, K, y);
  const Vec v = Vec::UnitZ() + in.shear_compliance.cwiseProduct(y.n);
  State d;
  for (int i = 0; i < 3; ++i) {  // direction cosines: d1' = tau d2 - k2 d3, and so on in turn
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    d.R.col(i) = u(k) * y.R.col(j) - u(j) * y.R.col(k);
    d.n(i) = -(u(j) * y.n(k) - u(k) * y.n(j)) - y.R.col(i).dot(in.w);
    d.m(i) = -(u(j) * y.m(k) - u(k) * y.m(j)) - (v(j) * y.n(k) - v(k) * y.n(j));
  }
  d.r = y.R * v;
  return d;
}

/// Points in the base frame at s = L i / stations, i = 0 .. stations.
inline std::vector<Point> solve(const Inputs& in, int stations, int steps_per_station) {
  const Vec K = stiffness(in);
  State y{Mat::Identity(), Vec::Zero(), in.F, in.M};
  std::vector<Point> points;
  const auto keep = [&] {
    points.push_back({y.R, y.r, curvature(in, K, y), in.shear_compliance.cwiseProduct(y.n), y.n, y.m + in.tendon});
  };
  keep();
  const Real h = -in.length / (stations * steps_per_station);
  for (int i = 0; i < stations; ++i) {
    for (int step = 0; step < steps_per_station; ++step) {
      const State k1 = rate(in, K, y), k2 = rate(in, K, y.plus(h / 2, k1)), k3 = rate(in, K, y.plus(h / 2, k2)),
                  k4 = rate(in, K, y.plus(h, k3));
      y = y.plus(h / 6, k1).plus(h / 3, k2).plus(h / 3, k3).plus(h / 6, k4);
    }
    keep();
  }
  const Mat R_base_tip = points.back().R.inverse();
  const Vec r_clamp = points.back().r;
  for (Point& p : points) p.R = R_base_tip * p.R, p.r = R_base_tip * (p.r - r_clamp);
  std::reverse(points.begin(), points.end());
  return points;
}

}  // namespace palpate::test::body_frame
