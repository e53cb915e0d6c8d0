// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <numbers>
#include <palpate/rod/base_loads.hpp>

#include "tests/rod/rod_cases.hpp"

/// Dead loads. What base_loads.hpp claims about stability is verified here by another road: the second variation of the
/// potential energy of a rod cut into segments of constant curvature (all its curvatures free, nothing reduced to the
/// tip, no tip frame). Verified: (1) while the least tip stiffness stays positive on the way from rest, the energy's
/// Hessian is positive definite; (2) beyond the crossing it has a negative eigenvalue, also where the least tip
/// stiffness has become positive again by passing a pole (a column at 8 Euler loads), so the path's memory is needed;
/// (3) the sign of det(dF_base/dF_tip) is that of the Hessian's determinant.
namespace palpate {
namespace {

using Status = EquilibriumStatus;

Equilibrium follow(const Rod& rod, const Vector3d& force_base_N) {
  const RodSolver solver(rod, std::vector<double>{}, Accuracy::kReference);
  return follow_from_rest(solver, {.force_base_N = force_base_N, .tip = {}});
}

double euler_load_N(const Rod& rod) {
  const Stiffness& K = rod.sections[0].stiffness_Nm2;
  return std::numbers::pi * std::numbers::pi * std::min(K(0), K(1)) / (4.0 * rod.length_m() * rod.length_m());
}

// ---------------------------------------------------------------------------------------------------------------
// Potential energy of segments of constant curvature

constexpr int kSegments = 20, kFreedoms = 3 * kSegments;
using Freedoms = Eigen::Matrix<double, kFreedoms, 1>;

/// E(x) = sum h (u - u0).K.(u - u0) / 2 - F.r(L), x = L u segment by segment, in units of K_min / L.
double energy(const Rod& rod, const Vector3d& force_base_N, const Freedoms& x) {
  const Section& section = rod.sections[0];
  const double L = rod.length_m(), h = L / kSegments;
  double elastic = 0.0;
  Matrix3d R = Matrix3d::Identity();
  Vector3d r = Vector3d::Zero();
  for (int i = 0; i < kSegments; ++i) {
    const Vector3d u = x.segment<3>(3 * i) / L, bend = u - section.precurvature_per_m, turn = h * u;
    elastic += 0.5 * h * bend.dot(section.stiffness_Nm2.cwiseProduct(bend));
    const double a2 = std::max(turn.squaredNorm(), 1e-12), a = std::sqrt(a2);
    const Matrix3d H = hat(turn);
    r += h *
         (R * (Vector3d::UnitZ() + (1.0 - std::cos(a)) / a2 * H.col(2) + (a - std::sin(a)) / (a2 * a) * H * H.col(2)));
    R = R * exp_so3(turn);
  }
  return (elastic - force_base_N.dot(r)) * L / section.stiffness_Nm2.minCoeff();
}

/// Eigenvalues of the energy's Hessian at the equilibrium, by central differences.
Freedoms energy_curvatures(const Rod& rod, const Vector3d& force_base_N, const TipLoad& load) {
  std::vector<double> middles;
  for (int i = 0; i < kSegments; ++i) middles.push_back(rod.length_m() * (i + 0.5) / kSegments);
  const RodSolution<0> solution = test::solve(rod, load, middles);
  Freedoms x;
  for (int i = 0; i < kSegments; ++i) x.segment<3>(3 * i) = rod.length_m() * solution.points[i].curvature_per_m;
  using Hessian = Eigen::Matrix<double, kFreedoms, kFreedoms>;
  Hessian hessian;
  constexpr double d = 1e-3;
  for (int i = 0; i < kFreedoms; ++i)
    for (int j = 0; j <= i; ++j) {
      const auto at = [&](double a, double b) {
        Freedoms y = x;
        y(i) += a * d, y(j) += b * d;
        return energy(rod, force_base_N, y);
      };
      hessian(i, j) = hessian(j, i) = (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * d * d);
    }
  return kSegments * Eigen::SelfAdjointEigenSolver<Hessian>(hessian, Eigen::EigenvaluesOnly).eigenvalues();
}

/// Negative eigenvalues; -1 where one is too close to zero for a rod of so few segments.
int negative_eigenvalues(const Rod& rod, const Vector3d& force_base_N, const Equilibrium& equilibrium) {
  const Freedoms c = energy_curvatures(rod, force_base_N, equilibrium.load);
  if (c.cwiseAbs().minCoeff() < 0.02) return -1;
  return static_cast<int>((c.array() < 0.0).count());
}

TEST(BaseLoads, StabilityIsThatOfTheWholeRodsEnergy) {
  std::mt19937_64 random(5);
  int stable = 0, unstable = 0;
  const auto check = [&](const Rod& rod, const Vector3d& F) {
    const Equilibrium equilibrium = follow(rod, F);
    ASSERT_EQ(equilibrium.load_factor, 1.0) << F.transpose();
    const int negative = negative_eigenvalues(rod, F, equilibrium);
    if (negative < 0) return;
    EXPECT_EQ(equilibrium.status == Status::kStable, negative == 0) << F.transpose();
    EXPECT_EQ(equilibrium.determinant > 0.0, negative % 2 == 0) << F.transpose();
    ++(negative == 0 ? stable : unstable);
  };
  for (int i = 0; i < 15; ++i) check(test::paper_catheter(39.99), test::uniform_in_ball(random, 0.4));
  for (int degree = 0; degree < 360; degree += 12) {
    const double a = degree * std::numbers::pi / 180.0;
    check(test::paper_catheter(39.99), 0.13 * Vector3d(0, std::sin(a), std::cos(a)));
  }
  const Rod column = test::paper_catheter(0.0);
  for (const double loads : {0.5, 0.9, 1.1, 1.4, 5.0, 8.0, 9.5}) check(column, {0, 0, -loads * euler_load_N(column)});
  EXPECT_GT(stable, 30);
  EXPECT_GT(unstable, 8);
}

TEST(BaseLoads, LeastTipStiffnessMayTurnPositiveAgainButTheBranchStaysUnstable) {
  const Rod column = test::paper_catheter(0.0);
  const Vector3d F(0, 0, -8.0 * euler_load_N(column));
  const Equilibrium beyond_the_pole = follow(column, F);
  EXPECT_GT(beyond_the_pole.least_tip_stiffness_Nm, 0.0);
  EXPECT_EQ(beyond_the_pole.status, Status::kUnstable);
  EXPECT_EQ(negative_eigenvalues(column, F, beyond_the_pole), 2);
}

// ---------------------------------------------------------------------------------------------------------------
// Euler's column

void check_euler_column(const Rod& rod) {
  const double P_critical = euler_load_N(rod);
  for (const double loads : {1.05, 1.37, 3.0, 5.0}) {
    const Equilibrium beyond = follow(rod, {0, 0, -loads * P_critical});
    EXPECT_EQ(beyond.status, Status::kUnstable);
    EXPECT_NEAR(beyond.critical_load_factor * loads, 1.0, 1e-6);
    EXPECT_LT((beyond.T_base_tip.p - Vector3d(0, 0, rod.length_m())).norm(), 1e-12);
  }
  const Equilibrium at = follow(rod, {0, 0, -P_critical});
  EXPECT_EQ(at.status, Status::kAtBifurcation);
  EXPECT_NEAR(at.determinant, 0.0, 1e-6);
  for (const double loads : {0.2, 0.99}) {
    const Equilibrium below = follow(rod, {0, 0, -loads * P_critical});
    EXPECT_EQ(below.status, Status::kStable);
    EXPECT_EQ(below.critical_load_factor, 0.0);
    EXPECT_GT(below.determinant, 0.0);
    EXPECT_GT(below.least_tip_stiffness_Nm, 0.0);
  }
  EXPECT_EQ(follow(rod, {0, 0, 10.0 * P_critical}).status, Status::kStable);  // pulled
}

TEST(BaseLoads, ColumnBucklesAtEulersLoad) { check_euler_column(test::paper_catheter(0.0)); }

TEST(BaseLoads, RoundColumnBucklesAtEulersLoadInAllDirectionsAtOnce) {
  check_euler_column(uniform_rod(0.1, {2e-4, 2e-4, 1.5e-4}, Vector3d::Zero()));
}

TEST(BaseLoads, DeterminantIsThatOfTheUnbentColumn) {
  // Small deflection of a column: tip slope per lateral tip force gives det = cos(a1) cos(a2), a = L sqrt(P/EI):
  // F_base,x = F_tip,x / cos(a) to first order, and 1 along the axis.
  const Rod rod = test::paper_catheter(0.0);
  const double P = 0.6 * euler_load_N(rod), L = rod.length_m();
  const Stiffness& K = rod.sections[0].stiffness_Nm2;
  EXPECT_NEAR(follow(rod, {0, 0, -P}).determinant,
              std::cos(L * std::sqrt(P / K(0))) * std::cos(L * std::sqrt(P / K(1))), 1e-9);
}

// ---------------------------------------------------------------------------------------------------------------
// The determinant, the residual, continuity

TEST(BaseLoads, DeterminantIsThatOfBaseForceByTipForce) {
  std::mt19937_64 random(6);
  const Rod rod = test::paper_catheter(39.99);
  const RodSolver solver(rod, std::vector<double>{}, Accuracy::kReference);
  auto solution = solver.make_solution<0>();
  const auto base_force = [&](const Vector3d& F_tip) -> Vector3d {
    solver.solve({.force_tip_N = F_tip}, solution);
    return solution.T_base_tip.R * F_tip;
  };
  for (int i = 0; i < 20; ++i) {
    const Equilibrium equilibrium = follow(rod, test::uniform_in_ball(random, 0.4));
    const Vector3d F = equilibrium.load.force_tip_N;
    Matrix3d J;
    constexpr double h = 1e-4;
    for (int k = 0; k < 3; ++k) {
      const Vector3d d = h * Vector3d::Unit(k);
      J.col(k) =
          (8.0 * (base_force(F + d) - base_force(F - d)) - (base_force(F + 2 * d) - base_force(F - 2 * d))) / (12 * h);
    }
    EXPECT_NEAR(equilibrium.determinant, J.determinant(), 1e-5 * (1.0 + J.norm() * J.norm() * J.norm()));
  }
  EXPECT_NEAR(follow(rod, Vector3d::Zero()).determinant, 1.0, 1e-12);
}

TEST(BaseLoads, AnswerIsAnEquilibriumUnderTheShareOfTheLoadThatWasReached) {
  std::mt19937_64 random(8);
  for (int i = 0; i < 40; ++i) {
    const Rod rod = test::paper_catheter(39.99);
    const Vector3d F = test::uniform_in_ball(random, 0.4);
    const BaseLoad load{.force_base_N = F,
                        .tip = {.force_tip_N = test::uniform_in_ball(random, 0.05),
                                .tendon_couple_Nm = test::uniform_in_ball(random, 2e-3)}};
    const RodSolver solver(rod, std::vector<double>{}, Accuracy::kReference);
    const Equilibrium equilibrium = follow_from_rest(solver, load);
    const RodSolution<0> again = test::solve(rod, equilibrium.load, {});
    const Vector3d dead = equilibrium.load.force_tip_N - equilibrium.load_factor * load.tip.force_tip_N;
    EXPECT_LT((again.T_base_tip.R * dead - equilibrium.load_factor * F).norm(), 1e-11);
    EXPECT_LT((again.T_base_tip.p - equilibrium.T_base_tip.p).norm(), 1e-12);
  }
}

/// A weight in the plane of the precurved catheter. Turning the weight a little moves the tip a little, or the status
/// changes.
TEST(BaseLoads, PlanarWeightReportsTheBifurcationsOnItsWayAndNeverJumps) {
  const Rod rod = test::paper_catheter(39.99);
  Equilibrium last;
  int unstable = 0;
  for (int degree = 0; degree <= 360; degree += 2) {
    const double a = degree * std::numbers::pi / 180.0;
    const Equilibrium now = follow(rod, 0.13 * Vector3d(0, std::sin(a), std::cos(a)));
    EXPECT_LT(std::abs(now.T_base_tip.p.x()), 1e-12);  // the plane is never left without a cause
    const bool same_status = now.status == last.status && now.load_factor == 1.0;
    if (degree > 0 && same_status) {
      EXPECT_LT((now.T_base_tip.p - last.T_base_tip.p).norm(), 7e-3) << degree;
    }
    if (now.status == Status::kUnstable) {
      ++unstable;
      EXPECT_GT(now.critical_load_factor, 0.7);
      EXPECT_LT(now.critical_load_factor, 1.0);
      EXPECT_LT(now.determinant, 0.0);
    }
    last = now;
  }
  EXPECT_NEAR(unstable, 28, 2);  // 47 to 103 degrees
}

/// Ever so slightly out of plane there is no bifurcation: the branch from rest leaves the plane and stays stable. The
/// in-plane equilibrium still exists close by, and must not be taken for it.
TEST(BaseLoads, AnImperfectionIsFollowedOutOfThePlane) {
  const Rod rod = test::paper_catheter(39.99);
  const Vector3d in_plane = 0.13 * Vector3d(0, std::sin(1.25), std::cos(1.25));
  const Vector3d limit = follow(rod, in_plane + Vector3d(1e-6, 0, 0)).T_base_tip.p;
  EXPECT_GT(limit.x(), 0.03);
  for (const double x_N : {1e-4, 1e-5, -1e-5, -1e-4}) {
    const Equilibrium out_of_plane = follow(rod, in_plane + Vector3d(x_N, 0, 0));
    EXPECT_EQ(out_of_plane.status, Status::kStable) << x_N;
    const Vector3d expected(std::copysign(limit.x(), x_N), limit.y(), limit.z());
    EXPECT_LT((out_of_plane.T_base_tip.p - expected).norm(), 1e-4) << x_N;
  }
}

// ---------------------------------------------------------------------------------------------------------------
// Own weight: planar elastica EI theta'' = -(P + w (L - s)) cos(theta), theta(0) = 0, theta'(L) = 0, by shooting

struct Elastica {
  double theta, x, z;
};

Elastica shoot(double EI, double L, double P, double w) {
  constexpr int n = 4000;
  using State = Eigen::Vector4d;  // theta, theta', x, z
  const auto end = [&](double slope) {
    const auto f = [&](double s, const State& y) {
      return State(y(1), -(P + w * (L - s)) * std::cos(y(0)) / EI, std::sin(y(0)), std::cos(y(0)));
    };
    State y(0.0, slope, 0.0, 0.0);
    const double h = L / n;
    for (int i = 0; i < n; ++i) {
      const double s = i * h;
      const State a = f(s, y), b = f(s + h / 2, y + h / 2 * a), c = f(s + h / 2, y + h / 2 * b),
                  d = f(s + h, y + h * c);
      y += h / 6 * (a + 2 * b + 2 * c + d);
    }
    return y;
  };
  double low = 0.0, high = (P + 0.5 * w * L) * L / EI;  // the moment on the clamp if the rod stayed straight
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (end(middle)(1) < 0.0 ? low : high) = middle;
  }
  const State y = end(0.5 * (low + high));
  return {y(0), y(2), y(3)};
}

TEST(BaseLoads, OwnWeightGivesTheElasticaWithSelfWeight) {
  for (const double heaviness : {0.5, 3.0, 8.0}) {
    Rod rod = test::paper_catheter(0.0);
    const double L = rod.length_m(), EI = rod.sections[0].stiffness_Nm2(1), w = heaviness * EI / (L * L * L);
    rod.distributed_load_base_N_per_m = {w, 0, 0};
    const RodSolver solver(rod, std::vector{0.5 * L, L}, Accuracy::kReference);

    const Elastica weight_only = shoot(EI, L, 0.0, w);
    auto workspace = make_weight_workspace<3>(solver);
    auto solution = solver.make_solution<3>();
    const WeightedSolve solve = solve_under_weight<3>(solver, {}, {}, workspace, solution);
    EXPECT_TRUE(solve.converged);
    EXPECT_LE(solve.evaluations, 8);
    EXPECT_LT((solution.T_base_tip.p - Vector3d(weight_only.x, 0, weight_only.z)).norm(), 1e-8 * L);
    EXPECT_NEAR(std::asin(solution.T_base_tip.R(0, 2)), weight_only.theta, 1e-8);

    const double P = 0.7 * EI / (L * L);
    const Elastica both = shoot(EI, L, P, w);
    const Equilibrium equilibrium = follow_from_rest(solver, {.force_base_N = {P, 0, 0}, .tip = {}});
    EXPECT_EQ(equilibrium.status, Status::kStable);
    EXPECT_LT((equilibrium.T_base_tip.p - Vector3d(both.x, 0, both.z)).norm(), 1e-8 * L);
  }
}

TEST(BaseLoads, OwnWeightByNewtonAndByContinuationAgree) {
  std::mt19937_64 random(9);
  for (int i = 0; i < 20; ++i) {
    Rod rod = test::paper_catheter(39.99);
    rod.distributed_load_base_N_per_m = test::uniform_in_ball(random, 1.0);
    const TipLoad load{.force_tip_N = test::uniform_in_ball(random, 0.05)};
    const RodSolver solver(rod, std::vector{0.07}, Accuracy::kReference);
    auto workspace = make_weight_workspace<3>(solver);
    auto solution = solver.make_solution<3>();
    EXPECT_TRUE(solve_under_weight<3>(solver, load, {}, workspace, solution).converged);
    const Equilibrium equilibrium = follow_from_rest(solver, {.force_base_N = Vector3d::Zero(), .tip = load});
    EXPECT_LT((equilibrium.T_base_tip.p - solution.T_base_tip.p).norm(), 1e-10);
    EXPECT_LT(
        (solution.T_base_tip.R * equilibrium.load.distributed_tip_N_per_m - rod.distributed_load_base_N_per_m).norm(),
        1e-9);
  }
}

TEST(BaseLoads, WithoutOwnWeightItIsOneIntegration) {
  const RodSolver solver(test::paper_catheter(20.0), std::vector{0.07});
  auto workspace = make_weight_workspace<3>(solver);
  auto solution = solver.make_solution<3>(), direct = solver.make_solution<3>();
  LoadDirections<3> d;
  d.force_tip_N.setIdentity();
  const TipLoad load{.force_tip_N = {0.05, 0.05, -0.1}};
  EXPECT_EQ(solve_under_weight<3>(solver, load, d, workspace, solution).evaluations, 1);
  solver.solve(load, d, direct);
  EXPECT_EQ(solution.points[0].T_base_local.p, direct.points[0].T_base_local.p);
  EXPECT_EQ(solution.tip_rotation, direct.tip_rotation);
}

}  // namespace
}  // namespace palpate
