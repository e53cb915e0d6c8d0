// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

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
  const auto field = [](double s, const double* y, double* dy) {
    const double excess = y[0] * y[0] + y[1] * y[1] - 1.0;
    dy[0] = -s * y[1] - excess * y[0];
    dy[1] = s * y[0] - excess * y[1];
  };
  const auto error = [&](int n) {
    const double h = 3.0 / n;
    double y[] = {1.0, 0.0};
    for (int i = 0; i < n; ++i) runge_kutta_step<method, 2, 1>(i * h, h, 1, y, field);
    return std::hypot(y[0] - std::cos(4.5), y[1] - std::sin(4.5));
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

TEST(RungeKutta, BlocksAreStatesOfTheirOwn) {
  // y' = s and y' = 2 s in blocks of one number: a step sums polynomials exactly.
  const auto field = [](double s, const double*, double* dy) { dy[0] = s, dy[1] = 2.0 * s; };
  double y[] = {0.0, 1.0, 7.0};
  runge_kutta_step<kDormandPrince8, 1, 2>(1.0, 0.5, 2, y, field);
  EXPECT_NEAR(y[0], 0.5 * (1.5 * 1.5 - 1.0), 1e-14);
  EXPECT_NEAR(y[1], 1.0 + (1.5 * 1.5 - 1.0), 1e-14);
  EXPECT_EQ(y[2], 7.0);
}

}  // namespace
}  // namespace palpate
