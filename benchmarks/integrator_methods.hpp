// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <palpate/math/pose.hpp>
#include <palpate/rod/field.hpp>
#include <palpate/rod/runge_kutta.hpp>
#include <string>
#include <vector>

/// The integrators that integrators.cpp compares, on one rod of one section.
namespace palpate {

/// A rod of one section under a tip load, and where its tip is.
struct Case {
  double length_m = 0.0;
  Vector3d force_N, moment_Nm, compliance_per_Nm2, free_curvature_per_m;
  Vector3d tip_m = Vector3d::Zero();
};

/// Tip position by one integrator with so many equal steps.
using Solver = std::function<Vector3d(const Case&, int steps)>;

struct Method {
  std::string name;
  int stages;
  Solver solve;
};

// ---------------------------------------------------------------------------------------------------------------
// On the quaternion and the position; what palpate does is Runge-Kutta

inline rod_lanes::Vec<double> scaled(double factor, const Vector3d& v) {
  return {factor * v.x(), factor * v.y(), factor * v.z()};
}

inline constexpr int kRows = rod_lanes::kRows<false>;

/// `step(field, y)` in units of the step, from the tip to the clamp.
template <class Step>
Vector3d along_quaternion(const Case& c, int steps, const Step& step) {
  using namespace rod_lanes;
  const double h = c.length_m / steps;
  const Parameters<double> p{.force = scaled(h, c.force_N),
                             .moment = scaled(1.0, c.moment_Nm),
                             .compliance = scaled(h, c.compliance_per_Nm2),
                             .free_curvature = scaled(h, c.free_curvature_per_m),
                             .distributed = {},
                             .shear_compliance = {}};
  const auto field = [&p](double tau, const double* y, double* dy) { rate<false>(section<false>(tau, y, p), y, dy); };
  double y[rod_lanes::kRows<false>] = {1.0};
  for (int i = 0; i < steps; ++i) {
    step(field, y);
    normalise(y);
  }
  const Eigen::Quaterniond q(y[0], y[1], y[2], y[3]);
  return h * (q.conjugate() * Vector3d(y[4], y[5], y[6]));  // -R^T r
}

template <const auto& method>
Vector3d on_quaternion(const Case& c, int steps) {
  return along_quaternion(
      c, steps, [](const auto& field, double* y) { runge_kutta_step<method, kRows, 1>(0.0, 1.0, 1, y, field); });
}

/// Collocation in the points x of [-1, 1]: y' is the polynomial through the rates there. Its stages are found by so
/// many Picard iterations, from a constant rate.
template <int Points>
struct Collocation {
  Eigen::Matrix<double, Points, Points> A;  ///< a_ij, integral of the j-th Lagrange polynomial up to point i
  Eigen::Matrix<double, Points, 1> b;       ///< up to 1

  explicit Collocation(const std::array<double, Points>& x) {
    Eigen::Matrix<double, Points, Points> powers;
    Eigen::Matrix<double, Points + 1, Points> integrals;
    for (int i = 0; i <= Points; ++i)
      for (int k = 0; k < Points; ++k) {
        const double at = i < Points ? x[i] : 1.0;
        if (i < Points) powers(i, k) = std::pow(at, k);
        integrals(i, k) = 0.5 * (std::pow(at, k + 1) - std::pow(-1.0, k + 1)) / (k + 1);
      }
    const Eigen::Matrix<double, Points + 1, Points> all = integrals * powers.inverse();
    A = all.template topRows<Points>();
    b = all.row(Points).transpose();
  }

  Vector3d solve(const Case& c, int steps, int iterations) const {
    return along_quaternion(c, steps, [&](const auto& field, double* y) {
      using State = Eigen::Matrix<double, kRows, 1>;
      Eigen::Map<State> start(y);
      Eigen::Matrix<double, kRows, Points> at = start.replicate<1, Points>(), rates = 0.0 * at;
      for (int i = 0; i < iterations; ++i) {
        for (int j = 0; j < Points; ++j) field(0.0, at.col(j).data(), rates.col(j).data());
        at = start.replicate<1, Points>() + rates * A.transpose();
      }
      start += rates * b;
    });
  }
};

inline constexpr int kGaussIterations = 8, kChebyshevPoints = 12, kChebyshevIterations = 12;

inline Vector3d gauss_6(const Case& c, int steps) {
  static const Collocation<3> method({-std::sqrt(0.6), 0.0, std::sqrt(0.6)});
  return method.solve(c, steps, kGaussIterations);
}

inline Vector3d chebyshev(const Case& c, int steps) {
  static const Collocation<kChebyshevPoints> method([] {
    std::array<double, kChebyshevPoints> x{};
    for (int i = 0; i < kChebyshevPoints; ++i) x[i] = -std::cos(std::numbers::pi * (i + 0.5) / kChebyshevPoints);
    return x;
  }());
  return method.solve(c, steps, kChebyshevIterations);
}

// ---------------------------------------------------------------------------------------------------------------
// Lie group methods on SE(3): T' = T hat(A(T)), A = -(u, e3); twists are (angular, linear)

using Twist = Eigen::Matrix<double, 6, 1>;

inline Pose exp_se3(const Twist& x) {
  const Vector3d w = x.head<3>(), v = x.tail<3>();
  const double a2 = w.squaredNorm(), a = std::sqrt(a2);
  const bool small = a < 1e-4;
  const double s = small ? 1.0 - a2 / 6.0 : std::sin(a) / a, c = small ? 0.5 - a2 / 24.0 : (1.0 - std::cos(a)) / a2,
               d = small ? 1.0 / 6.0 - a2 / 120.0 : (1.0 - s) / a2;
  const Vector3d wv = w.cross(v);
  const Matrix3d H = hat(w);
  return {Matrix3d::Identity() + s * H + c * H * H, v + c * wv + d * w.cross(wv)};
}

inline Twist bracket(const Twist& x, const Twist& y) {
  Twist z;
  z.head<3>() = x.head<3>().cross(y.head<3>());
  z.tail<3>() = x.head<3>().cross(y.tail<3>()) + x.tail<3>().cross(y.head<3>());
  return z;
}

inline Twist body_rate(const Case& c, const Pose& T) {
  Twist A;
  A << -(c.free_curvature_per_m +
         c.compliance_per_Nm2.cwiseProduct(T.R.transpose() * (c.moment_Nm - T.p.cross(c.force_N)))),
      -Vector3d::UnitZ();
  return A;
}

template <class Step>
Vector3d on_se3(const Case& c, int steps, const Step& step) {
  Pose T;
  for (int i = 0; i < steps; ++i) T = T * step(T, c.length_m / steps);
  return T.inverse().p;
}

/// Runge-Kutta-Munthe-Kaas: T = T0 exp(x), x' = dexp^-1(A) = A + [x,A]/2 + [x,[x,A]]/12 - ad^4/720 + ad^6/30240 - ...
template <const auto& method>
Vector3d munthe_kaas(const Case& c, int steps) {
  constexpr int stages = std::decay_t<decltype(method)>::stages;
  return on_se3(c, steps, [&c](const Pose& T0, double h) {
    const auto field = [&](double, const double* at, double* rate) {
      const Eigen::Map<const Twist> x(at);
      Eigen::Map<Twist> dx(rate);
      const Twist A = body_rate(c, T0 * exp_se3(x));
      const Twist xA = bracket(x, A), xxA = bracket(x, xA);
      dx = A + 0.5 * xA + xxA / 12.0;
      if constexpr (stages > 4) {
        const Twist ad4 = bracket(x, bracket(x, xxA));
        dx -= ad4 / 720.0;
        if constexpr (stages > 7) dx += bracket(x, bracket(x, ad4)) / 30240.0;
      }
    };
    Twist x = Twist::Zero();
    runge_kutta_step<method, 6, 1>(0.0, h, 1, x.data(), field);
    return exp_se3(x);
  });
}

/// Commutator-free method of order 4 in 4 stages and 5 exponentials (Celledoni, Marthinsen, Owren 2003).
inline Vector3d commutator_free_4(const Case& c, int steps) {
  return on_se3(c, steps, [&c](const Pose& T, double h) {
    const auto rate = [&](const Pose& at) -> Twist { return h * body_rate(c, at); };
    const Twist k1 = rate(T);
    const Pose half = exp_se3(0.5 * k1);
    const Twist k2 = rate(T * half), k3 = rate(T * exp_se3(0.5 * k2));
    const Twist k4 = rate(T * half * exp_se3(k3 - 0.5 * k1));
    return exp_se3((3.0 * k1 + 2.0 * k2 + 2.0 * k3 - k4) / 12.0) *
           exp_se3((-k1 + 2.0 * k2 + 2.0 * k3 + 3.0 * k4) / 12.0);
  });
}

inline const std::vector<Method>& methods() {
  static const std::vector<Method> all{
      {"Dormand-Prince 8", 12, on_quaternion<kDormandPrince8>},  // the chosen one: first, so drawn boldest
      {"Runge-Kutta 4", 4, on_quaternion<kRungeKutta4>},
      {"Butcher 6", 7, on_quaternion<kButcher6>},
      {"Cooper-Verner 8", 11, on_quaternion<kCooperVerner8>},
      {"CF4 on SE(3)", 4, commutator_free_4},
      {"RKMK 4 on SE(3)", 4, munthe_kaas<kRungeKutta4>},
      {"RKMK 6 on SE(3)", 7, munthe_kaas<kButcher6>},
      {"RKMK 8 on SE(3)", 12, munthe_kaas<kDormandPrince8>},
      {"Gauss 6 (Picard)", 3 * kGaussIterations, gauss_6},
      {"Chebyshev 12 (Picard)", kChebyshevPoints * kChebyshevIterations, chebyshev},
  };
  return all;
}

}  // namespace palpate
