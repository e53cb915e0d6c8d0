// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/rod/integration.hpp>

/// The kernel is written once over its scalar type: a wider float must give the same rod, only with less rounding.
namespace palpate {
namespace {

template <class T>
rod_field::State<T, 3, true> clamp_state() {
  using namespace rod_field;
  Parameters<T, 3> p;
  p.force << T(0.03), T(-0.05), T(-0.1);
  p.moment << T(1e-3), T(-5e-4), T(2e-4);
  p.distributed << T(0.2), T(0.0), T(-0.4);
  p.compliance << T(1) / T(0.2612e-3), T(1) / T(0.16664e-3), T(1) / T(0.1645e-3);
  p.free_curvature << T(24.57), T(0), T(0);
  p.shear_compliance << T(1e-3), T(1e-3), T(2e-4);
  p.d_force.setIdentity();
  p.d_moment.setZero();
  p.d_distributed.setZero();
  p.d_log_stiffness.setZero();
  p.d_free_curvature.setZero();
  State<T, 3, true> y = State<T, 3, true>::Zero();
  y(0, 0) = T(1);
  integrate_piece<kDormandPrince8, true>(T(0), T(0.07), 12, p, y);
  return y;
}

TEST(Kernel, AgreesInDoubleAndLongDouble) {
  const auto in_double = clamp_state<double>();
  const auto in_long_double = clamp_state<long double>();
  const auto difference = static_cast<double>((in_double.cast<long double>() - in_long_double).cwiseAbs().maxCoeff());
  const double largest = in_double.cwiseAbs().maxCoeff();
  EXPECT_GT(difference, 0.0) << "else nothing was computed in the wider type";
  EXPECT_LT(difference, 1e-13 * largest);
}

}  // namespace
}  // namespace palpate
