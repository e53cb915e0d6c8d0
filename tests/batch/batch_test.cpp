// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "tests/batch/batch_cases.hpp"

/// The batch solver against the reference rods and, rod by rod, against RodSolver.
namespace palpate {
namespace {

using test::ManyLoads;

/// Largest differences, in units of the length or relative.
struct Differences {
  double pose = 0.0, curvature = 0.0, tangents = 0.0;
};

Matrix3d matrix(const BatchMatrices& rows, Eigen::Index i) { return rows.col(i).reshaped<Eigen::RowMajor>(3, 3); }

double relative(const Matrix3d& ours, const Matrix3d& expected, double scale) {
  return (ours - expected).norm() / (expected.norm() + scale);
}

/// A tangent that is nought by cancellation is measured against what it is the difference of: `scale`.
void compare(const BatchPoints& ours, Eigen::Index i, const RodPoint& point, const RodPointTangent<3>& tangent,
             double length_m, Differences& worst) {
  const Pose& T = point.T_base_local;
  worst.pose = std::max({worst.pose, (ours.p_base_local_m.col(i) - T.p).norm() / length_m, (ours.R(i) - T.R).norm()});
  worst.curvature = std::max(worst.curvature, (ours.curvature_per_m.col(i) - point.curvature_per_m).norm() * length_m);
  if (ours.d_rotation.cols() == 0) return;
  worst.tangents = std::max({worst.tangents, relative(matrix(ours.d_rotation, i), tangent.rotation, 1.0),
                             relative(matrix(ours.d_position_m, i), tangent.position_m, length_m),
                             relative(matrix(ours.d_curvature_per_m, i), tangent.curvature_per_m, 1.0 / length_m)});
}

/// Batch against one by one, at the tip and all stations.
Differences against_one_by_one(const RodSolver& solver, const ManyLoads& loads, const BatchOptions& options) {
  BatchSolution batch;
  solve_batch(solver, loads.arrays(), options, batch);
  RodSolution<3> one = solver.make_solution<3>();
  LoadDirections<3> along_force;
  along_force.force_tip_N.setIdentity();
  const double length_m = solver.rod().length_m();
  Differences worst;
  for (std::size_t i = 0; i < loads.force.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    solver.solve(loads[i], along_force, one);
    const Pose& tip = one.T_base_tip;
    worst.pose = std::max({worst.pose, (batch.tip.p_base_local_m.col(column) - tip.p).norm() / length_m,
                           (batch.tip.R(column) - tip.R).norm()});
    if (options.force_sensitivities)
      worst.tangents = std::max(worst.tangents, relative(matrix(batch.tip.d_rotation, column), one.tip_rotation, 1.0));
    for (std::size_t k = 0; k < one.points.size(); ++k)
      compare(batch.stations[k], column, one.points[k], one.tangents[k], length_m, worst);
  }
  return worst;
}

void expect_equal(const std::string& what, const RodSolver& solver, const ManyLoads& loads, bool sensitivities) {
  for (const InstructionSet set : test::sets_here()) {
    const Differences worst =
        against_one_by_one(solver, loads, {.force_sensitivities = sensitivities, .workers = 1, .instructions = set});
    std::cout << fmt::format("[ measured ] {}, {}: pose {:.1e}, curvature {:.1e}, tangents {:.1e}\n", what, name(set),
                             worst.pose, worst.curvature, worst.tangents);
    EXPECT_LT(worst.pose, 1e-12) << what << ", " << name(set);
    EXPECT_LT(worst.curvature, 1e-12) << what << ", " << name(set);
    EXPECT_LT(worst.tangents, 1e-11) << what << ", " << name(set);
  }
}

TEST(Batch, TenThousandRodsAreThoseSolvedOneByOne) {
  const RodSolver solver(test::paper_catheter(24.57), std::vector{0.0653});
  expect_equal("paper's catheter", solver, test::random_loads(10000, 1), false);
}

TEST(Batch, SectionsRigidPartsAndContactOffsetAreThoseOfTheSolver) {
  const RodSolver solver(test::rod_of_sections(), test::kPlaces_m);
  expect_equal("sections", solver, test::random_loads(1000, 2), true);
}

TEST(Batch, ShearAndDistributedLoadAreThoseOfTheSolver) {
  expect_equal("shear", RodSolver(test::shearing_rod(), test::kPlaces_m), test::random_loads(500, 3), true);
  expect_equal("distributed load", RodSolver(test::rod_of_sections(), test::kPlaces_m), test::random_loads(500, 4, 0.5),
               true);
  expect_equal("both", RodSolver(test::shearing_rod(), test::kPlaces_m), test::random_loads(500, 5, 0.5), true);
}

TEST(Batch, ReproducesTheReferenceRods) {
  PALPATE_NEEDS_SHARED(test::kRodStatics);
  for (const test::ReferenceRod& reference : test::reference_rods()) {
    std::vector<double> s;
    for (const auto& station : reference.stations) s.push_back(station.s_m);
    const RodSolver solver(reference.rod, s, Accuracy::kReference);
    const std::vector force{reference.load.force_tip_N}, moment{reference.load.moment_tip_Nm};
    for (const InstructionSet set : test::sets_here()) {
      BatchSolution ours;
      solve_batch(solver, {.force_tip_N = force, .moment_tip_Nm = moment}, {.instructions = set}, ours);
      const double length_m = reference.rod.length_m();
      for (std::size_t k = 0; k < s.size(); ++k) {
        const auto& [s_m, T, u] = reference.stations[k];
        EXPECT_LT((ours.stations[k].p_base_local_m.col(0) - T.p).norm() / length_m, 1e-8) << name(set);
        EXPECT_LT(log_so3(T.R.transpose() * ours.stations[k].R(0)).norm(), 1e-8) << name(set);
        EXPECT_LT((ours.stations[k].curvature_per_m.col(0) - u).norm() * length_m, 1e-8) << name(set);
      }
      const Vector3d force_base_N = ours.tip.R(0) * reference.load.force_tip_N;
      EXPECT_LT((force_base_N - reference.force_base_N).norm(), 1e-8);
    }
  }
}

TEST(Batch, EachArrayMayBeLeftOut) {
  const RodSolver solver(test::rod_of_sections(), std::vector{0.05});
  const ManyLoads loads = test::random_loads(20, 6);
  BatchSolution batch;
  solve_batch(solver, {.precurvature_per_m = loads.precurvature}, {}, batch);
  for (std::size_t i = 0; i < 20; ++i) {
    RodSolution<0> one = solver.make_solution<0>();
    solver.solve({.precurvature_per_m = loads.precurvature[i]}, one);
    EXPECT_LT((batch.stations[0].p_base_local_m.col(i) - one.points[0].T_base_local.p).norm(), 1e-14);
  }
  solve_batch(solver, {}, {.force_sensitivities = true}, batch);
  EXPECT_EQ(batch.tip.p_base_local_m.cols(), 0);
}

}  // namespace
}  // namespace palpate
