// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/math/errors.hpp>
#include <random>

#include "tests/rod/tangent_columns.hpp"

/// The kernels for all instruction sets give the same rod: shape and derivatives of every solver, to rounding.
namespace palpate {
namespace {

using test::Column;

Rod shearing(Rod rod) {
  rod.shear_stiffness_N = 300.0;
  rod.axial_stiffness_N = 900.0;
  return rod;
}

TipLoad random_load(std::mt19937_64& random, bool distributed) {
  TipLoad load{.force_tip_N = test::uniform_in_ball(random, 0.3), .moment_tip_Nm = test::uniform_in_ball(random, 3e-3)};
  load.tendon_couple_Nm = test::uniform_in_ball(random, 3e-3);
  load.log_stiffness = test::uniform_in_ball(random, 0.3);
  load.precurvature_per_m = test::uniform_in_ball(random, 10.0);
  if (distributed) load.distributed_tip_N_per_m = test::uniform_in_ball(random, 1.0);
  return load;
}

template <int N>
LoadDirections<N> first(const LoadDirections<12>& d) {
  LoadDirections<N> out;
  out.force_tip_N = d.force_tip_N.leftCols<N>();
  out.moment_tip_Nm = d.moment_tip_Nm.leftCols<N>();
  out.tendon_couple_Nm = d.tendon_couple_Nm.leftCols<N>();
  out.log_stiffness = d.log_stiffness.leftCols<N>();
  out.precurvature_per_m = d.precurvature_per_m.leftCols<N>();
  out.distributed_tip_N_per_m = d.distributed_tip_N_per_m.leftCols<N>();
  return out;
}

/// Every column that the kernels have room for.
LoadDirections<15> all_columns(const LoadDirections<12>& d) {
  LoadDirections<15> out;
  out.force_tip_N << d.force_tip_N, d.force_tip_N.leftCols<3>();
  out.moment_tip_Nm << d.moment_tip_Nm, d.moment_tip_Nm.rightCols<3>();
  out.tendon_couple_Nm << d.tendon_couple_Nm, d.tendon_couple_Nm.leftCols<3>();
  out.log_stiffness << d.log_stiffness, d.log_stiffness.rightCols<3>();
  out.precurvature_per_m << d.precurvature_per_m, d.precurvature_per_m.leftCols<3>();
  out.distributed_tip_N_per_m << d.distributed_tip_N_per_m, d.distributed_tip_N_per_m.rightCols<3>();
  return out;
}

template <int N>
RodSolution<N> solved(const Rod& rod, const TipLoad& load, const LoadDirections<N>& d, InstructionSet set) {
  const double places_m[] = {0.074, 0.07, 0.0, 0.02, 0.033, 0.0653};
  const RodSolver solver(rod, places_m, Accuracy::kRealtime, set);
  RodSolution<N> solution = solver.make_solution<N>();
  solver.solve(load, d, solution);
  return solution;
}

template <int N>
void expect_same_rod(const Rod& rod, const TipLoad& load, const LoadDirections<N>& d, InstructionSet set) {
  const RodSolution<N> base = solved(rod, load, d, InstructionSet::kBaseline), other = solved(rod, load, d, set);
  const Column gap = test::differences(other, base);
  const double L = rod.length_m();
  for (const auto& outputs : gap) {
    EXPECT_LT(outputs[test::kRotation].norm(), 1e-12);
    EXPECT_LT(outputs[test::kPosition].norm(), 1e-12 * L);
    EXPECT_LT(outputs[test::kCurvature].norm() * L, 1e-12);
    EXPECT_LT(outputs[test::kForce].norm(), 1e-12);
    EXPECT_LT(outputs[test::kMoment].norm(), 1e-12 * L);
    EXPECT_LT(outputs[test::kShear].norm(), 1e-12);
  }
  if constexpr (N > 0)
    for (int j = 0; j < N; ++j)
      test::worst_relative_error(test::exact_column(other, j), test::exact_column(base, j), name(set), 1e-11);
}

TEST(InstructionSets, AllGiveTheSameRod) {
  std::mt19937_64 random(7);
  for (const InstructionSet set : {InstructionSet::kAvx2, InstructionSet::kAvx512})
    for (int i = 0; available(set) && i < 100; ++i) {
      const bool distributed = i % 4 >= 2;
      const Rod rod = i % 2 == 0 ? test::jointed_rod() : shearing(test::jointed_rod());
      const TipLoad load = random_load(random, distributed);
      const LoadDirections<12> d = test::mixed_directions(random, distributed);
      expect_same_rod<0>(rod, load, {}, set);
      expect_same_rod(rod, load, first<3>(d), set);
      expect_same_rod(rod, load, first<6>(d), set);
      expect_same_rod(rod, load, first<9>(d), set);
      expect_same_rod(rod, load, d, set);
      expect_same_rod(rod, load, all_columns(d), set);
    }
}

TEST(InstructionSets, WhatTheProcessorLacksIsRefused) {
  const auto none = static_cast<InstructionSet>(7);
  EXPECT_FALSE(available(none));
  EXPECT_THROW(RodSolver(test::jointed_rod(), std::vector{0.07}, Accuracy::kRealtime, none), InputError);
}

TEST(InstructionSets, TheValueDoesNotDependOnItsTangents) {
  std::mt19937_64 random(8);
  const TipLoad load = random_load(random, true);
  const LoadDirections<12> d = test::mixed_directions(random, true);
  for (const InstructionSet set : kInstructionSets) {
    if (!available(set)) continue;
    const RodSolution<0> alone = solved<0>(test::jointed_rod(), load, {}, set);
    const RodSolution<3> few = solved(test::jointed_rod(), load, first<3>(d), set);
    const RodSolution<12> many = solved(test::jointed_rod(), load, d, set);
    for (std::size_t i = 0; i < alone.points.size(); ++i) {
      EXPECT_LT((alone.points[i].T_base_local.p - few.points[i].T_base_local.p).norm(), 1e-14) << name(set);
      EXPECT_LT((alone.points[i].T_base_local.p - many.points[i].T_base_local.p).norm(), 1e-14) << name(set);
      EXPECT_LT((alone.points[i].moment_local_Nm - many.points[i].moment_local_Nm).norm(), 1e-15) << name(set);
    }
  }
}

/// The same kernel alone decides: a narrower one is really taken (its rounding differs), and taken twice it is the
/// same.
TEST(InstructionSets, OneIsTheSameBitsAgain) {
  std::mt19937_64 random(9);
  const TipLoad load = random_load(random, false);
  const LoadDirections<3> d = first<3>(test::mixed_directions(random, false));
  const auto p = [&](InstructionSet set) { return solved(test::jointed_rod(), load, d, set).tangents[3].position_m; };
  for (const InstructionSet set : kInstructionSets)
    if (available(set)) {
      EXPECT_EQ(p(set), p(set));
    }
  if (available(InstructionSet::kAvx2)) {
    EXPECT_NE(p(InstructionSet::kAvx2), p(InstructionSet::kBaseline));
  }
}

}  // namespace
}  // namespace palpate
