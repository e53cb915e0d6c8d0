// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <palpate/rod/runge_kutta.hpp>

namespace palpate {
namespace {

/// Largest violation of the quadrature conditions sum_i b_i c_i^(k-1) = 1/k up to k = order.
template <const auto& method>
double quadrature_defect(int order) {
  double worst = 0.0;
  for (int k = 1; k <= order; ++k) {
    double sum = 0.0;
    for (int i = 0; i < method.stages; ++i) sum += method.b[i] * std::pow(method.c(i), k - 1);
    worst = std::max(worst, std::abs(sum - 1.0 / k));
  }
  return worst;
}

/// Observed order on a non-autonomous, non-linear system with a known solution: y' = s (-y1, y0) + (|y|^2 - 1) y.
template <const auto& method>
double observed_order(int steps) {
  const auto field = [](double s, const Eigen::Vector2d& y, Eigen::Vector2d& dy) {
    dy = s * Eigen::Vector2d(-y(1), y(0)) - (y.squaredNorm() - 1.0) * y;
  };
  const auto error = [&](int n) {
    const double h = 3.0 / n;
    Eigen::Vector2d y(1.0, 0.0);
    for (int i = 0; i < n; ++i) runge_kutta_step<method>(i * h, h, y, field);
    return (y - Eigen::Vector2d(std::cos(4.5), std::sin(4.5))).norm();
  };
  return std::log2(error(steps) / error(2 * steps));
}

TEST(RungeKutta, TableausMeetTheQuadratureConditionsOfTheirOrder) {
  EXPECT_LT(quadrature_defect<kRungeKutta4>(4), 1e-15);
  EXPECT_LT(quadrature_defect<kButcher6>(6), 1e-15);
  EXPECT_LT(quadrature_defect<kCooperVerner8>(8), 1e-14);
  EXPECT_LT(quadrature_defect<kDormandPrince8>(8), 1e-14);
}

TEST(RungeKutta, MethodsConvergeWithTheirOrder) {
  EXPECT_GT(observed_order<kRungeKutta4>(64), 3.8);
  EXPECT_GT(observed_order<kButcher6>(32), 5.8);
  EXPECT_GT(observed_order<kCooperVerner8>(16), 7.6);
  EXPECT_GT(observed_order<kDormandPrince8>(16), 7.6);
}

}  // namespace
}  // namespace palpate
