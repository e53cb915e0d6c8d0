// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <palpate/rod/statics.hpp>
#include <string>
#include <vector>

#include "tests/rod/rod_cases.hpp"

/// Derivatives of everything a solution holds along one direction, to be compared with differences.
namespace palpate::test {

enum Output { kRotation, kPosition, kCurvature, kShear, kForce, kMoment, kOutputs };
inline constexpr const char* kNames[] = {"rotation", "position", "curvature", "shear", "force", "moment"};

/// Derivatives of all outputs along one direction, station by station.
using Column = std::vector<std::array<Vector3d, kOutputs>>;

template <int N>
Column exact_column(const RodSolution<N>& solution, int j) {
  Column column;
  for (const RodPointTangent<N>& t : solution.tangents)
    column.push_back({t.rotation.col(j), t.position_m.col(j), t.curvature_per_m.col(j), t.shear_strain.col(j),
                      t.force_local_N.col(j), t.moment_local_Nm.col(j)});
  return column;
}

/// Fourth-order central difference of `values(step)`, the outputs relative to those at step 0.
template <class Values>
Column central_difference(const Values& values, double h) {
  const Column p1 = values(h), m1 = values(-h), p2 = values(2 * h), m2 = values(-2 * h);
  Column d = p1;
  for (std::size_t i = 0; i < d.size(); ++i)
    for (int o = 0; o < kOutputs; ++o) d[i][o] = (8.0 * (p1[i][o] - m1[i][o]) - (p2[i][o] - m2[i][o])) / (12.0 * h);
  return d;
}

inline double worst_relative_error(const Column& exact, const Column& other, const std::string& where, double allowed) {
  double worst = 0.0;
  for (int o = 0; o < kOutputs; ++o) {
    double scale = 0.0, error = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      scale = std::max(scale, other[i][o].cwiseAbs().maxCoeff());
      error = std::max(error, (exact[i][o] - other[i][o]).cwiseAbs().maxCoeff());
    }
    if (error == 0.0) continue;
    EXPECT_LT(error, allowed * scale) << where << ", " << kNames[o];
    worst = std::max(worst, error / scale);
  }
  return worst;
}

template <int N>
Column differences(const RodSolution<N>& p, const RodSolution<N>& base) {
  Column column;
  for (std::size_t i = 0; i < p.points.size(); ++i) {
    const RodPoint &a = p.points[i], &b = base.points[i];
    column.push_back({log_so3(b.T_base_local.R.transpose() * a.T_base_local.R), a.T_base_local.p - b.T_base_local.p,
                      a.curvature_per_m - b.curvature_per_m, a.shear_strain - b.shear_strain,
                      a.force_local_N - b.force_local_N, a.moment_local_Nm - b.moment_local_Nm});
  }
  return column;
}

inline std::vector<int> step_counts(const RodSolver& solver, const TipLoad& load) {
  std::vector<int> counts;
  for (const RodSolver::Piece& piece : solver.pieces()) {
    const double angle = piece.length_m * solver.curvature_bound_per_m(load);
    const rod_lanes::Steps steps = rod_lanes::steps_over(angle, piece.from_sigma_m == 0.0, solver.step_rule());
    counts.push_back(steps.sixth_order ? 0 : steps.count);
  }
  return counts;
}

/// The rod whose description is changed as TipLoad::log_stiffness and precurvature_per_m say: what they mean.
inline Rod changed_rod(Rod rod, const Vector3d& log_stiffness, const Vector3d& precurvature_per_m) {
  for (Section& section : rod.sections)
    if (!section.rigid) {
      section.stiffness_Nm2.array() *= log_stiffness.array().exp();
      section.precurvature_per_m += precurvature_per_m;
    }
  return rod;
}

/// Mixed directions in units in which all inputs matter alike.
inline LoadDirections<12> mixed_directions(std::mt19937_64& random, bool distributed) {
  LoadDirections<12> d;
  for (int j = 0; j < 12; ++j) {
    d.force_tip_N.col(j) = test::uniform_in_ball(random, 0.1);
    d.moment_tip_Nm.col(j) = test::uniform_in_ball(random, 3e-3);
    d.tendon_couple_Nm.col(j) = test::uniform_in_ball(random, 3e-3);
    d.log_stiffness.col(j) = test::uniform_in_ball(random, 1.0);
    d.precurvature_per_m.col(j) = test::uniform_in_ball(random, 15.0);
    if (distributed) d.distributed_tip_N_per_m.col(j) = test::uniform_in_ball(random, 1.0);
  }
  return d;
}

/// A shaft of three sections, one of them rigid, with a rigid tip and the force off its axis.
inline Rod jointed_rod() {
  Rod rod;
  rod.sections = {{0.0, 0.03, {3e-4, 2e-4, 2e-4}, {20, 0, 3}, false},
                  {0.03, 0.036, Stiffness::Zero(), {10, 0, 0}, true},
                  {0.036, 0.07, {1.5e-4, 1.5e-4, 1e-4}, {10, 5, 0}, false}};
  rod.rigid_tip_m = 0.006;
  rod.contact_offset_m = {0.001, 0, 0.006};
  return rod;
}

}  // namespace palpate::test
