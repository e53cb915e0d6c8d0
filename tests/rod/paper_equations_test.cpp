// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>

#include "tests/rod/rod_cases.hpp"

/// The paper's own road, Eqs. (5), (6), (7) as printed (with the dots that (5) lacks), and what is wrong with Eq. (8).
namespace palpate {
namespace {

constexpr int kSteps = 2000;

template <class State, class Rate>
State runge_kutta_4(const State& y, double h, const Rate& f) {
  const State a = f(y, 0), b = f(y + h / 2 * a, 1), c = f(y + h / 2 * b, 1), d = f(y + h * c, 2);
  return y + h / 6 * (a + 2 * b + 2 * c + d);
}

/// (k1, k2, tau) at s = L i / (2 kSteps), from the tip to the clamp.
std::vector<Vector3d> curvatures(const Rod& rod, const TipLoad& load) {
  using State = Eigen::Matrix<double, 6, 1>;
  const Section& section = rod.sections[0];
  const double EI1 = section.stiffness_Nm2(0), EI2 = section.stiffness_Nm2(1), GJ = section.stiffness_Nm2(2);
  const double k10 = section.precurvature_per_m(0), k20 = section.precurvature_per_m(1),
               t0 = section.precurvature_per_m(2);
  const auto rate = [&](const State& y, int) {
    const double n1 = y(0), n2 = y(1), n3 = y(2), k1 = y(3), k2 = y(4), t = y(5);
    State d;
    d << -(k2 * n3 - t * n2), -(t * n1 - k1 * n3), -(k1 * n2 - k2 * n1),
        -((GJ - EI2) * k2 * t + t * EI2 * k20 - k2 * GJ * t0 - n2) / EI1,
        -((EI1 - GJ) * k1 * t + k1 * GJ * t0 - t * EI1 * k10 + n1) / EI2,
        -((EI2 - EI1) * k1 * k2 + k2 * EI1 * k10 - k1 * EI2 * k20) / GJ;
    return d;
  };
  State y;
  y << load.force_tip_N, section.precurvature_per_m + load.moment_tip_Nm.cwiseQuotient(section.stiffness_Nm2);
  std::vector<Vector3d> u(2 * kSteps + 1);
  for (int i = 2 * kSteps; i >= 0; --i) {
    u[i] = y.tail<3>();
    if (i > 0) y = runge_kutta_4(y, -rod.length_m() / (2 * kSteps), rate);
  }
  return u;
}

enum class Tangent { kThirdColumn, kAsPrinted };

/// (theta, psi, phi) by (7) and the tip's position, from the clamp to the tip.
Eigen::Matrix<double, 6, 1> tip_by_euler_angles(const Rod& rod, const std::vector<Vector3d>& u, Tangent tangent) {
  using State = Eigen::Matrix<double, 6, 1>;
  State y = State::Zero();
  for (int i = 0; i < kSteps; ++i) {
    const auto rate = [&](const State& at, int half) {
      const double st = std::sin(at(0)), ct = std::cos(at(0)), ss = std::sin(at(1)), cs = std::cos(at(1)),
                   sp = std::sin(at(2)), cp = std::cos(at(2));
      Matrix3d E;
      E << cp, -sp, 0, sp / ct, cp / ct, 0, sp * st / ct, cp * st / ct, 1;
      State d;
      if (tangent == Tangent::kThirdColumn)
        d << E * u[2 * i + half], ct * ss, -st, ct * cs;
      else
        d << E * u[2 * i + half], -cp * ss + sp * st * cs, sp * ss + st * cp * cs, ct * cs;
      return d;
    };
    y = runge_kutta_4(y, rod.length_m() / kSteps, rate);
  }
  return y;
}

TEST(PaperEquations, FiveSixAndSevenWithTheThirdColumnGiveTheSameRod) {
  std::mt19937_64 random(15);
  double least_defect_of_printed = 1.0;
  for (int i = 0; i < 20; ++i) {
    const Rod rod = uniform_rod(0.07, {0.2612e-3, 0.16664e-3, 0.1645e-3}, test::uniform_in_ball(random, 8.0));
    const TipLoad load{.force_tip_N = test::uniform_in_ball(random, 0.04),
                       .moment_tip_Nm = test::uniform_in_ball(random, 1e-3)};
    const Pose ours = test::solve(rod, load, {}).T_base_tip;
    const auto u = curvatures(rod, load);
    const auto y = tip_by_euler_angles(rod, u, Tangent::kThirdColumn);
    const Matrix3d R = (Eigen::AngleAxisd(y(1), Vector3d::UnitY()) * Eigen::AngleAxisd(y(0), Vector3d::UnitX()) *
                        Eigen::AngleAxisd(y(2), Vector3d::UnitZ()))
                           .toRotationMatrix();
    EXPECT_LT((ours.p - y.tail<3>()).norm(), 1e-8 * rod.length_m());
    EXPECT_LT((ours.R - R).norm(), 1e-8);
    const auto printed = tip_by_euler_angles(rod, u, Tangent::kAsPrinted);
    least_defect_of_printed = std::min(least_defect_of_printed, (ours.p - printed.tail<3>()).norm());
  }
  EXPECT_GT(least_defect_of_printed, 1e-3);  // metres
}

TEST(PaperEquations, EulerAnglesAreSingularWhereAPrecurvedShaftReachesARightAngle) {
  const double k1_per_m = std::numbers::pi / 2 / 0.07;
  EXPECT_NEAR(k1_per_m, 22.4, 0.05);
  const Matrix3d R = test::solve(test::paper_catheter(k1_per_m), {}, {}).T_base_tip.R;
  EXPECT_NEAR(std::abs(R(1, 2)), 1.0, 1e-9);  // -sin(theta)
}

}  // namespace
}  // namespace palpate
