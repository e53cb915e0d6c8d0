// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/rod/dead_load.hpp>

#include "tests/rod/rod_cases.hpp"

/// The warm solver against continuation from rest, and its derivatives against differences of continuation.
namespace palpate {
namespace {

constexpr int kColumns = 12;

struct Inputs {
  Rod rod;
  Vector3d force_N;
};

Inputs random_inputs(std::mt19937_64& random, bool shears) {
  Inputs in{test::paper_catheter(12.0), test::uniform_in_ball(random, 0.1)};
  in.rod.distributed_load_base_N_per_m = test::uniform_in_ball(random, 0.5);
  in.rod.contact_offset_m = {0.001, 0.0, 0.004};
  if (shears) in.rod.shear_stiffness_N = 6.0, in.rod.axial_stiffness_N = 15.0;
  return in;
}

/// Columns: log stiffness, precurvature, force, distributed load.
Inputs moved(Inputs in, int column, double step) {
  const int axis = column % 3;
  Section& section = in.rod.sections[0];
  if (column < 3) section.stiffness_Nm2(axis) *= std::exp(step);
  if (column >= 3 && column < 6) section.precurvature_per_m(axis) += step;
  if (column >= 6 && column < 9) in.force_N(axis) += step;
  if (column >= 9) in.rod.distributed_load_base_N_per_m(axis) += step;
  return in;
}

DeadLoadDirections<kColumns> all_directions() {
  DeadLoadDirections<kColumns> d;
  d.log_stiffness.leftCols<3>().setIdentity();
  d.precurvature_per_m.middleCols<3>(3).setIdentity();
  d.force_base_N.middleCols<3>(6).setIdentity();
  d.distributed_tip_N_per_m.rightCols<3>().setIdentity();
  return d;
}

const std::vector<double> kStations{0.02, 0.05, 0.07};

RodSolution<0> by_continuation(const Inputs& in) {
  const RodSolver solver(in.rod, kStations, Accuracy::kReference);
  auto shape = solver.make_solution<0>();
  solver.solve(follow_from_rest(solver, {.force_base_N = in.force_N, .tip = {}}).load, shape);
  return shape;
}

DeadLoadSolution<kColumns> by_newton(const Inputs& in, const Matrix3d& R_tip_base, double tangent_suffices_rad) {
  const RodSolver solver(in.rod, kStations, Accuracy::kReference);
  auto solution = make_dead_load_solution<kColumns>(solver);
  const DeadLoad load{in.force_N, in.rod.distributed_load_base_N_per_m, {}};
  EXPECT_TRUE(solve_dead_load(solver, load, all_directions(), R_tip_base, solution, tangent_suffices_rad).converged);
  return solution;
}

TEST(DeadLoad, FromNearbyItFindsTheShapeThatContinuationFinds) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 20; ++i) {
    const Inputs in = random_inputs(random, i % 2);
    const RodSolution<0> truth = by_continuation(in);
    const Matrix3d near = truth.T_base_tip.R.transpose() * exp_so3(test::uniform_in_ball(random, 0.2));
    for (const double tangent_rad : {1e-6, 1e-4}) {
      const auto found = by_newton(in, near, tangent_rad);
      for (std::size_t k = 0; k < kStations.size(); ++k) {
        const Pose &a = found.shape.points[k].T_base_local, &b = truth.points[k].T_base_local;
        EXPECT_LT((a.p - b.p).norm(), 1e-11 + 0.1 * tangent_rad * tangent_rad);
        EXPECT_LT(log_so3(a.R.transpose() * b.R).norm(), 1e-9 + tangent_rad * tangent_rad);
      }
    }
  }
}

TEST(DeadLoad, DerivativesAreThoseOfContinuation) {
  std::mt19937_64 random(4);
  const double steps[] = {1e-3, 1e-1, 1e-4, 1e-3};
  for (int i = 0; i < 6; ++i) {
    const Inputs in = random_inputs(random, i % 2);
    const auto at = by_newton(in, by_continuation(in).T_base_tip.R.transpose(), 1e-6);
    for (int column = 0; column < kColumns; ++column) {
      const double h = steps[column / 3];
      const RodSolution<0> plus = by_continuation(moved(in, column, h)), minus = by_continuation(moved(in, column, -h));
      for (std::size_t k = 0; k < kStations.size(); ++k) {
        const Pose &a = plus.points[k].T_base_local, &b = minus.points[k].T_base_local;
        const Vector3d by_p = (a.p - b.p) / (2.0 * h), by_R = log_so3(b.R.transpose() * a.R) / (2.0 * h);
        const RodPointTangent<kColumns>& exact = at.shape.tangents[k];
        const double p_scale = at.shape.tangents.back().position_m.col(column).norm();
        const double R_scale = at.shape.tangents.back().rotation.col(column).norm();
        EXPECT_LT((exact.position_m.col(column) - by_p).norm(), 2e-4 * p_scale) << "column " << column;
        EXPECT_LT((exact.rotation.col(column) - by_R).norm(), 2e-4 * R_scale) << "column " << column;
      }
      const Vector3d turn = log_so3(minus.T_base_tip.R * plus.T_base_tip.R.transpose()) / (2.0 * h);
      EXPECT_LT((at.turn.col(column) - turn).norm(), 2e-4 * at.turn.col(column).norm()) << "column " << column;
    }
  }
}

TEST(DeadLoad, DeterminantIsThatOfContinuation) {
  const Inputs in{test::paper_catheter(39.99), {0.03, 0.08, 0.02}};
  const RodSolver solver(in.rod, kStations, Accuracy::kReference);
  const Equilibrium truth = follow_from_rest(solver, {.force_base_N = in.force_N, .tip = {}});
  EXPECT_NEAR(by_newton(in, truth.T_base_tip.R.transpose(), 1e-6).determinant, truth.determinant, 1e-6);
}

}  // namespace
}  // namespace palpate
