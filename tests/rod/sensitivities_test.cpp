// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <iostream>
#include <palpate/rod/base_loads.hpp>

#include "tests/rod/body_frame_rod.hpp"
#include "tests/rod/rod_cases.hpp"
#include "tests/rod/tangent_columns.hpp"

/// Exact sensitivities against derivatives found otherwise. Errors are relative to the largest entry that the same
/// output has, along the whole rod, in the same column.
namespace palpate {
namespace {

using test::central_difference;
using test::Column;
using test::differences;
using test::exact_column;
using test::jointed_rod;
using test::mixed_directions;
using test::step_counts;
using test::worst_relative_error;

void report(const std::string& what, double worst) {
  std::cout << fmt::format("[ measured ] {}: {:.2e}\n", what, worst);
  testing::Test::RecordProperty(what, fmt::format("{:.3e}", worst));
}

// ---------------------------------------------------------------------------------------------------------------
// Against the body-frame equations

namespace bf = test::body_frame;

constexpr int kStations = 5, kStepsPerStation = 80;

/// Differences to `base`, in long double so that the quotient keeps its digits.
Column differences(const std::vector<bf::Point>& p, const std::vector<bf::Point>& base) {
  Column column;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const bf::Mat turn = base[i].R.transpose() * p[i].R;
    bf::Vec v(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
    v /= 2;
    const bf::Real sine = v.norm();
    if (sine > 1e-12L) v *= std::asin(sine) / sine;
    const auto d = [](const bf::Vec& a, const bf::Vec& b) -> Vector3d { return (a - b).cast<double>(); };
    column.push_back({v.cast<double>(), d(p[i].r, base[i].r), d(p[i].u, base[i].u), d(p[i].shear, base[i].shear),
                      d(p[i].n, base[i].n), d(p[i].m, base[i].m)});
  }
  return column;
}

struct Parameter {
  const char* name;
  bf::Vec bf::Inputs::*field;
  double step;
};

const Parameter kParameters[] = {
    {"tip force", &bf::Inputs::F, 1e-4},          {"tip moment", &bf::Inputs::M, 1e-5},
    {"tendon couple", &bf::Inputs::tendon, 1e-5}, {"log stiffness", &bf::Inputs::log_stiffness, 1e-3},
    {"precurvature", &bf::Inputs::u0, 1e-2},      {"distributed load", &bf::Inputs::w, 1e-3},
};

struct RandomRod {
  Rod rod;
  TipLoad load;
  bf::Inputs inputs;
};

RandomRod random_rod(std::mt19937_64& random, bool shears, bool distributed) {
  std::uniform_real_distribution<double> unit;
  const Vector3d K = 1e-4 * Vector3d(1.0 + 3.0 * unit(random), 1.0 + 3.0 * unit(random), 1.0 + 3.0 * unit(random));
  RandomRod a{uniform_rod(0.05 + 0.05 * unit(random), K, test::uniform_in_ball(random, 25.0)),
              {.force_tip_N = test::uniform_in_ball(random, 0.15),
               .moment_tip_Nm = test::uniform_in_ball(random, 3e-3),
               .tendon_couple_Nm = test::uniform_in_ball(random, 3e-3)},
              {}};
  if (shears) a.rod.shear_stiffness_N = 2.0 + 8.0 * unit(random), a.rod.axial_stiffness_N = 5.0 + 20.0 * unit(random);
  if (distributed) a.load.distributed_tip_N_per_m = test::uniform_in_ball(random, 1.0);

  const auto wide = [](const Vector3d& v) -> bf::Vec { return v.cast<bf::Real>(); };
  a.inputs = {.length = a.rod.length_m(),
              .F = wide(a.load.force_tip_N),
              .M = wide(a.load.moment_tip_Nm),
              .tendon = wide(a.load.tendon_couple_Nm),
              .log_stiffness = wide(K).array().log().matrix(),
              .u0 = wide(a.rod.sections[0].precurvature_per_m),
              .w = wide(a.load.distributed_tip_N_per_m)};
  if (shears)
    a.inputs.shear_compliance << 1.0L / a.rod.shear_stiffness_N, 1.0L / a.rod.shear_stiffness_N,
        1.0L / a.rod.axial_stiffness_N;
  return a;
}

/// All eighteen columns: five inputs in one solution, the distributed load in another.
std::vector<Column> exact_columns(const RandomRod& a) {
  std::vector<double> s;
  for (int i = 0; i <= kStations; ++i) s.push_back(std::min(a.rod.length_m(), a.rod.length_m() * i / kStations));
  const RodSolver solver(a.rod, s, Accuracy::kReference);
  LoadDirections<15> d;
  d.force_tip_N.middleCols<3>(0).setIdentity();
  d.moment_tip_Nm.middleCols<3>(3).setIdentity();
  d.tendon_couple_Nm.middleCols<3>(6).setIdentity();
  d.log_stiffness.middleCols<3>(9).setIdentity();
  d.precurvature_per_m.middleCols<3>(12).setIdentity();
  LoadDirections<3> by_weight;
  by_weight.distributed_tip_N_per_m.setIdentity();
  auto solution = solver.make_solution<15>();
  auto weight_solution = solver.make_solution<3>();
  solver.solve(a.load, d, solution);
  solver.solve(a.load, by_weight, weight_solution);
  std::vector<Column> columns;
  for (int j = 0; j < 15; ++j) columns.push_back(exact_column(solution, j));
  for (int j = 0; j < 3; ++j) columns.push_back(exact_column(weight_solution, j));
  EXPECT_LT((solution.tip_rotation - solution.tangents.back().rotation).norm(), 1e-12 * solution.tip_rotation.norm());
  EXPECT_LT((weight_solution.tip_rotation - weight_solution.tangents.back().rotation).norm(), 1e-12);
  return columns;
}

double compare_with_body_frame(const RandomRod& a, const std::string& where) {
  const std::vector<bf::Point> base = bf::solve(a.inputs, kStations, kStepsPerStation);
  const std::vector<Column> exact = exact_columns(a);
  double worst = 0.0;
  int column = 0;
  for (const Parameter& parameter : kParameters)
    for (int k = 0; k < 3; ++k, ++column) {
      const auto values = [&](double step) {
        bf::Inputs moved = a.inputs;
        (moved.*parameter.field)(k) += step;
        return differences(bf::solve(moved, kStations, kStepsPerStation), base);
      };
      worst = std::max(worst, worst_relative_error(exact[column], central_difference(values, parameter.step),
                                                   fmt::format("{}, {} {}", where, parameter.name, k), 1e-6));
    }
  return worst;
}

TEST(Sensitivities, KirchhoffRodAgreesWithTheBodyFrameEquations) {
  std::mt19937_64 random(11);
  double worst = 0.0;
  for (int i = 0; i < 100; ++i)
    worst = std::max(worst, compare_with_body_frame(random_rod(random, false, false), fmt::format("rod {}", i)));
  report("sensitivities_kirchhoff", worst);
}

TEST(Sensitivities, ShearStretchAndDistributedLoadAgreeWithTheBodyFrameEquations) {
  std::mt19937_64 random(12);
  double worst = 0.0;
  for (int i = 0; i < 60; ++i)
    worst =
        std::max(worst, compare_with_body_frame(random_rod(random, i % 3 != 0, i % 3 != 1), fmt::format("rod {}", i)));
  report("sensitivities_full", worst);
}

TEST(Sensitivities, ValuesAgreeWithTheBodyFrameEquations) {
  std::mt19937_64 random(13);
  for (int i = 0; i < 40; ++i) {
    const RandomRod a = random_rod(random, i % 2, i % 4 > 1);
    const std::vector<bf::Point> other = bf::solve(a.inputs, kStations, kStepsPerStation);
    std::vector<double> s;
    for (int k = 0; k <= kStations; ++k) s.push_back(std::min(a.rod.length_m(), a.rod.length_m() * k / kStations));
    const RodSolution<0> ours = test::solve(a.rod, a.load, s);
    for (int k = 0; k <= kStations; ++k) {
      const RodPoint& p = ours.points[k];
      EXPECT_LT((p.T_base_local.p - other[k].r.cast<double>()).norm(), 2e-8 * a.rod.length_m());
      EXPECT_LT((p.T_base_local.R - other[k].R.cast<double>()).norm(), 1e-7);
      EXPECT_LT((p.curvature_per_m - other[k].u.cast<double>()).norm(), 1e-7 / a.rod.length_m());
      EXPECT_LT((p.shear_strain - other[k].shear.cast<double>()).norm(), 1e-8);
      EXPECT_LT((p.force_local_N - other[k].n.cast<double>()).norm(), 1e-8);
      EXPECT_LT((p.moment_local_Nm - other[k].m.cast<double>()).norm(), 1e-9);
    }
  }
}

// ---------------------------------------------------------------------------------------------------------------
// Against finite differences of the same solver. Tangents solve the variational equation beside the shape, to its
// accuracy: as near as differences tell at the reference setting, 1e-6 at the real-time one.

struct Inputs {
  Rod rod;
  TipLoad load;
};

template <int N>
Inputs moved(Inputs a, const LoadDirections<N>& d, int j, double step) {
  a.load.force_tip_N += step * d.force_tip_N.col(j);
  a.load.moment_tip_Nm += step * d.moment_tip_Nm.col(j);
  a.load.tendon_couple_Nm += step * d.tendon_couple_Nm.col(j);
  a.load.distributed_tip_N_per_m += step * d.distributed_tip_N_per_m.col(j);
  a.rod = test::changed_rod(a.rod, step * d.log_stiffness.col(j), step * d.precurvature_per_m.col(j));
  return a;
}

double compare_with_own_differences(const Inputs& a, const LoadDirections<12>& d, double h, double allowed,
                                    int& checked, Accuracy accuracy) {
  const std::vector<double> s{0.076, 0.07, 0.05, 0.033, 0.0};
  const RodSolver solver(a.rod, s, accuracy);
  auto base = solver.make_solution<12>();
  solver.solve(a.load, d, base);
  double worst = 0.0;
  for (int j = 0; j < 12; ++j) {
    bool same_steps = true;
    const auto values = [&](double step) {
      const Inputs b = moved(a, d, j, step);
      const RodSolver other(b.rod, s, accuracy);
      same_steps = same_steps && step_counts(other, b.load) == step_counts(solver, a.load);
      auto solution = other.make_solution<12>();
      other.solve(b.load, d, solution);
      return differences(solution, base);
    };
    const Column difference = central_difference(values, h);
    if (!same_steps) continue;
    ++checked;
    worst =
        std::max(worst, worst_relative_error(exact_column(base, j), difference, fmt::format("column {}", j), allowed));
  }
  return worst;
}

void check_own_differences(Accuracy accuracy, double allowed) {
  std::mt19937_64 random(21);
  double worst = 0.0;
  int checked = 0;
  for (int i = 0; i < 24; ++i) {
    const bool shears = i % 3 == 1, distributed = i % 3 == 2;
    Inputs a{jointed_rod(), {.force_tip_N = test::uniform_in_ball(random, 0.3)}};
    if (shears) a.rod.shear_stiffness_N = 5.0, a.rod.axial_stiffness_N = 12.0;
    const LoadDirections<12> d = mixed_directions(random, distributed);
    worst = std::max(worst, compare_with_own_differences(a, d, 2e-4, allowed, checked, accuracy));
  }
  EXPECT_GT(checked, 100);
  report("sensitivities_own_differences", worst);
}

TEST(Sensitivities, AreTheDerivativesOfTheShape) { check_own_differences(Accuracy::kReference, 1e-8); }

TEST(Sensitivities, AreAsGoodAsTheShapeInRealTime) { check_own_differences(Accuracy::kRealtime, 1e-6); }

// ---------------------------------------------------------------------------------------------------------------
// Total derivatives under the rod's own weight

template <int N>
void check_totals_under_weight(int seed) {
  std::mt19937_64 random(seed);
  double worst = 0.0;
  for (int i = 0; i < 12; ++i) {
    Inputs a{jointed_rod(), {.force_tip_N = test::uniform_in_ball(random, 0.1)}};
    a.rod.distributed_load_base_N_per_m = test::uniform_in_ball(random, 1.0);
    const LoadDirections<12> mixed = mixed_directions(random, false);
    LoadDirections<N> d;
    d.force_tip_N = mixed.force_tip_N.leftCols<N>();
    d.precurvature_per_m = mixed.precurvature_per_m.leftCols<N>();
    d.log_stiffness = mixed.log_stiffness.leftCols<N>();
    const auto solve = [&](const Inputs& in) {
      const RodSolver solver(in.rod, std::vector{0.076, 0.07, 0.05, 0.0}, Accuracy::kReference);
      auto workspace = make_weight_workspace<N>(solver);
      auto solution = solver.make_solution<N>();
      EXPECT_TRUE(solve_under_weight<N>(solver, in.load, d, workspace, solution).converged);
      return solution;
    };
    const RodSolution<N> base = solve(a);
    EXPECT_LT((base.tip_rotation - base.tangents[1].rotation).norm(), 1e-12 * base.tip_rotation.norm());
    for (int j = 0; j < N; ++j)
      worst = std::max(
          worst, worst_relative_error(
                     exact_column(base, j),
                     central_difference([&](double h) { return differences(solve(moved(a, d, j, h)), base); }, 2e-3),
                     fmt::format("rod {} column {}", i, j), 1e-6));
  }
  report(fmt::format("totals_under_weight_{}", N), worst);
}

TEST(Sensitivities, UnderOwnWeightAreTotalDerivativesOfThree) { check_totals_under_weight<3>(31); }
TEST(Sensitivities, UnderOwnWeightAreTotalDerivativesOfTwelve) { check_totals_under_weight<12>(32); }

}  // namespace
}  // namespace palpate
