// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <iostream>
#include <limits>
#include <palpate/math/errors.hpp>

#include "tests/rod/rod_cases.hpp"

/// Accuracy of the fast path against solutions made elsewhere, and the step rule's promises.
namespace palpate {
namespace {

using test::ReferenceRod;

struct Errors {
  double position = 0.0;   // share of the length
  double rotation = 0.0;   // rad
  double curvature = 0.0;  // times the length
  double orthonormality = 0.0;

  void take(const RodPoint& ours, const Pose& pose, const Vector3d& u, double length_m) {
    const Matrix3d& R = ours.T_base_local.R;
    position = std::max(position, (ours.T_base_local.p - pose.p).norm() / length_m);
    rotation = std::max(rotation, log_so3(pose.R.transpose() * R).norm());
    curvature = std::max(curvature, (ours.curvature_per_m - u).norm() * length_m);
    orthonormality = std::max(orthonormality, (R.transpose() * R - Matrix3d::Identity()).norm());
  }

  std::string text() const {
    return fmt::format("position {:.2e} L, rotation {:.2e} rad, curvature {:.2e} / L, |R^T R - I| {:.1e}", position,
                       rotation, curvature, orthonormality);
  }
};

enum class Stations { kAll, kEnds, kTip };

std::vector<std::size_t> pick(const ReferenceRod& reference, Stations stations) {
  const std::size_t last = reference.stations.size() - 1;
  if (stations == Stations::kTip) return {last};
  if (stations == Stations::kEnds) return {0, last};
  std::vector<std::size_t> all(last + 1);
  for (std::size_t i = 0; i <= last; ++i) all[i] = i;
  return all;
}

/// Only kAll cuts the rod between its ends; with the others the step rule gets no help from the cuts.
Errors worst_on_reference_rods(Accuracy accuracy, Stations stations) {
  Errors worst;
  for (const ReferenceRod& reference : test::reference_rods()) {
    std::vector<double> s;
    for (const std::size_t i : pick(reference, stations)) s.push_back(reference.stations[i].s_m);
    const RodSolution<0> ours = test::solve(reference.rod, reference.load, s, accuracy);
    std::size_t row = 0;
    for (const std::size_t i : pick(reference, stations))
      worst.take(ours.points[row++], reference.stations[i].T_base_local, reference.stations[i].curvature_per_m,
                 reference.rod.length_m());
  }
  return worst;
}

void report(const std::string& what, const Errors& worst) {
  std::cout << "[ measured ] " << what << ": " << worst.text() << '\n';
  testing::Test::RecordProperty(what, worst.text());
}

TEST(Statics, ReferenceSettingReproducesTheReferenceRods) {
  PALPATE_NEEDS_SHARED(test::kRodStatics);
  ASSERT_EQ(test::reference_rods().size(), 40u);
  for (const auto& [stations, name] :
       {std::pair(Stations::kAll, "all"), std::pair(Stations::kEnds, "ends"), std::pair(Stations::kTip, "tip")}) {
    const Errors worst = worst_on_reference_rods(Accuracy::kReference, stations);
    report(fmt::format("reference_{}_stations", name), worst);
    EXPECT_LT(worst.position, 1e-8) << name;
    EXPECT_LT(worst.rotation, 1e-8) << name;
    EXPECT_LT(worst.curvature, 1e-8) << name;
    EXPECT_LT(worst.orthonormality, 1e-14) << name;
  }
}

TEST(Statics, RealtimeSettingStaysWithinItsPromiseOnTheReferenceRods) {
  PALPATE_NEEDS_SHARED(test::kRodStatics);
  for (const auto& [stations, name] :
       {std::pair(Stations::kAll, "all"), std::pair(Stations::kEnds, "ends"), std::pair(Stations::kTip, "tip")}) {
    const Errors worst = worst_on_reference_rods(Accuracy::kRealtime, stations);
    report(fmt::format("realtime_{}_stations", name), worst);
    EXPECT_LT(worst.position, 1e-5) << name;
    EXPECT_LT(worst.orthonormality, 1e-14) << name;
  }
}

TEST(Statics, RealtimeSettingHoldsOneMillionthOfTheLengthOnThePapersCatheter) {
  std::mt19937_64 random(20260101);
  std::uniform_real_distribution<double> k1_per_m(0.0, 60.0);
  Errors worst;
  double steps = 0.0;
  constexpr int kTrials = 2000;
  for (int i = 0; i < kTrials; ++i) {
    const Rod rod = test::paper_catheter(k1_per_m(random));
    const TipLoad load{.force_tip_N = test::uniform_in_ball(random, 0.4)};
    const RodPoint realtime = test::solve(rod, load, {rod.length_m()}, Accuracy::kRealtime).points[0];
    const RodPoint reference = test::solve(rod, load, {rod.length_m()}, Accuracy::kReference).points[0];
    worst.take(realtime, reference.T_base_local, reference.curvature_per_m, rod.length_m());
    const RodSolver solver(rod, std::vector{rod.length_m()});
    steps += std::ceil(rod.length_m() * solver.curvature_bound_per_m(load) / solver.step_rule().angle) / kTrials;
  }
  report("realtime_on_the_papers_catheter", worst);
  std::cout << fmt::format("[ measured ] mean steps {:.2f}\n", steps);
  EXPECT_LT(worst.position, 1e-6);
}

TEST(Statics, CurvatureStaysBelowTheBoundOfTheStepRule) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> k1_per_m(0.0, 60.0);
  for (int i = 0; i < 200; ++i) {
    const Rod rod = test::paper_catheter(k1_per_m(random));
    const TipLoad load{.force_tip_N = test::uniform_in_ball(random, 0.4),
                       .moment_tip_Nm = test::uniform_in_ball(random, 5e-3),
                       .tendon_couple_Nm = test::uniform_in_ball(random, 5e-3)};
    std::vector<double> s;
    for (int k = 0; k <= 20; ++k) s.push_back(0.0035 * k);
    const RodSolver solver(rod, s);
    const RodSolution<0> solution = test::solve(rod, load, s);
    for (const RodPoint& point : solution.points)
      EXPECT_LE(point.curvature_per_m.norm(), solver.curvature_bound_per_m(load));
  }
}

TEST(Statics, ReferenceFilesBaseForceIsTheTipForceTurned) {
  PALPATE_NEEDS_SHARED(test::kRodStatics);
  for (const ReferenceRod& reference : test::reference_rods()) {
    const RodSolution<0> ours = test::solve(reference.rod, reference.load, {});
    EXPECT_LT((ours.T_base_tip.R * reference.load.force_tip_N - reference.force_base_N).norm(), 1e-8);
  }
}

TEST(Statics, StationsComeBackInTheOrderAskedFor) {
  const Rod rod = test::paper_catheter(30.0);
  const TipLoad load{.force_tip_N = {0.05, 0.05, -0.1}};
  const RodSolution<0> mixed = test::solve(rod, load, {0.02, 0.07, 0.0, 0.05, 0.02});
  const RodSolution<0> sorted = test::solve(rod, load, {0.0, 0.02, 0.05, 0.07});
  const int rank[] = {1, 3, 0, 2, 1};
  for (int i = 0; i < 5; ++i)
    EXPECT_LT((mixed.points[i].T_base_local.p - sorted.points[rank[i]].T_base_local.p).norm(), 1e-12);
  EXPECT_LT(mixed.points[2].T_base_local.p.norm(), 1e-16);
  EXPECT_LT((mixed.points[2].T_base_local.R - Matrix3d::Identity()).norm(), 1e-14);
}

TEST(Statics, AbsurdLoadsEndInTimeAndNotFiniteOnesInNotFiniteShapes) {
  const Rod rod = test::paper_catheter(30.0);
  test::solve(rod, {.force_tip_N = {1e9, 0, 0}}, {0.07});
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double force_N : {infinity, std::nan("")})
    EXPECT_FALSE(test::solve(rod, {.force_tip_N = {force_N, 0, 0}}, {0.07}).T_base_tip.p.allFinite());
}

TEST(Statics, StationOutsideTheShaftIsRefusedWithItsValue) {
  Rod rod = test::paper_catheter(0.0);
  EXPECT_THROW(RodSolver(rod, std::vector{0.0701}), InputError);
  EXPECT_THROW(RodSolver(rod, std::vector{-0.001}), InputError);
  EXPECT_THROW(RodSolver(rod, std::vector{std::nan("")}), InputError);
  rod.rigid_tip_m = 0.004;
  EXPECT_NO_THROW(RodSolver(rod, std::vector{0.074}));
}

}  // namespace
}  // namespace palpate
