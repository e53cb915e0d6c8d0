// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <palpate/batch/batch.hpp>
#include <palpate/rod/reach.hpp>

namespace palpate {
namespace {

constexpr double kLength_m = 0.07;

RodSolver solver(int pieces) {
  std::vector<double> stations;
  for (int i = 0; i <= pieces; ++i) stations.push_back(kLength_m * i / pieces);
  return RodSolver(uniform_rod(kLength_m, {0.2612e-3, 0.16664e-3, 0.1645e-3}, {24.57, 0.0, 0.0}), stations);
}

TipLoad pushed_by(double force_N) { return {.force_tip_N = force_N * Vector3d(0.0, 0.6, -0.8)}; }

Vector3d tip_m(const RodSolver& solver, const TipLoad& load) {
  auto solution = solver.make_solution<0>();
  solver.solve(load, solution);
  return solution.T_base_tip.p;
}

/// Against the rod in 400 pieces, for which the steps are enough: within reach the shape is as accurate as ever, and
/// beyond it some of these are not.
TEST(Reach, TellsWhichShapesAreNotAsAccurateAsAsked) {
  const RodSolver whole = solver(1), fine = solver(400);
  double worst_beyond = 0.0;
  int within = 0;
  for (double force_N = 0.1; force_N < 2e4; force_N *= 1.5) {
    const TipLoad load = pushed_by(force_N);
    ASSERT_TRUE(within_reach(fine, load));
    const double error = (tip_m(whole, load) - tip_m(fine, load)).norm() / kLength_m;
    if (within_reach(whole, load)) {
      ++within;
      EXPECT_LT(error, 1e-6) << force_N;
    } else {
      worst_beyond = std::max(worst_beyond, error);
    }
  }
  EXPECT_GT(within, 20);
  EXPECT_GT(worst_beyond, 1e-3);
}

TEST(Reach, WhatIsNotFiniteIsBeyondIt) {
  for (const double force_N :
       {1e300, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    EXPECT_FALSE(within_reach(solver(50), pushed_by(force_N))) << force_N;
  EXPECT_TRUE(within_reach(solver(1), TipLoad{}));
}

TEST(Reach, TheBatchTellsItRodByRod) {
  std::vector<Vector3d> force_N;
  force_N.reserve(1000);
  for (int i = 0; i < 1000; ++i) force_N.push_back(pushed_by(i % 3 == 1 ? 1e4 : 0.2).force_tip_N);
  BatchSolution solution;
  solve_batch(solver(1), {.force_tip_N = force_N}, {}, solution);
  for (std::size_t i = 0; i < force_N.size(); ++i) EXPECT_EQ(solution.within_reach[i], i % 3 == 1 ? 0 : 1) << i;
}

}  // namespace
}  // namespace palpate
