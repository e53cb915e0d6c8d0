// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <palpate/rod/field.hpp>
#include <palpate/rod/runge_kutta.hpp>

/// The field is written once over its scalar type: a wider float must give the same rod, only with less rounding.
namespace palpate {
namespace {

constexpr int kRows = rod_lanes::kRows<true>, kColumns = 4;

/// Value and three tangents at the clamp, in units of the step.
template <class T>
std::array<T, kColumns * kRows> clamp_state() {
  using namespace rod_lanes;
  const T h = T(0.07) / T(12);
  Parameters<T> p;
  p.force = h * Vec<T>{T(0.03), T(-0.05), T(-0.1)};
  p.moment = {T(1e-3), T(-5e-4), T(2e-4)};
  p.distributed = h * h * Vec<T>{T(0.2), T(0), T(-0.4)};
  p.compliance = h * Vec<T>{T(1) / T(0.2612e-3), T(1) / T(0.16664e-3), T(1) / T(0.1645e-3)};
  p.free_curvature = {h * T(24.57), T(0), T(0)};
  p.shear_compliance = T(1) / h * Vec<T>{T(1e-3), T(1e-3), T(2e-4)};
  const Vec<T> zero{T(0), T(0), T(0)};
  Direction<T> along[3];
  for (Direction<T>& d : along) d = {{zero, zero}, zero, zero, zero};
  along[0].force.x = along[1].force.y = along[2].force.z = h;

  std::array<T, kColumns * kRows> y{};
  y[0] = T(1);
  const auto field = [&](const T& tau, const T* at, T* out) {
    const Section<T> o = section<true>(tau, at, p);
    rate<true>(o, at, out);
    for (int c = 1; c < kColumns; ++c) rate_tangent<true>(o, tau, at + c * kRows, p, along[c - 1], out + c * kRows);
  };
  for (int i = 0; i < 12; ++i) {
    runge_kutta_step<kDormandPrince8, kRows, kColumns>(T(i), T(1), kColumns, y.data(), field);
    normalise(y.data());
  }
  return y;
}

TEST(Kernel, AgreesInDoubleAndLongDouble) {
  const auto in_double = clamp_state<double>();
  const auto in_long_double = clamp_state<long double>();
  double difference = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < in_double.size(); ++i) {
    difference = std::max(difference, static_cast<double>(std::abs(in_double[i] - in_long_double[i])));
    largest = std::max(largest, std::abs(in_double[i]));
  }
  EXPECT_GT(difference, 0.0) << "else nothing was computed in the wider type";
  EXPECT_LT(difference, 1e-13 * largest);
}

}  // namespace
}  // namespace palpate
