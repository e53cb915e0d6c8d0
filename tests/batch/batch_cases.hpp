// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/batch/batch.hpp>
#include <random>
#include <string>
#include <vector>

#include "tests/rod/rod_cases.hpp"

namespace palpate::test {

/// Loads of every kind, and the same as arrays.
struct ManyLoads {
  std::vector<Vector3d> force, moment, couple, distributed, log_stiffness, precurvature;

  TipLoad operator[](std::size_t i) const {
    return {.force_tip_N = force[i],
            .moment_tip_Nm = moment[i],
            .tendon_couple_Nm = couple[i],
            .distributed_tip_N_per_m = distributed.empty() ? Vector3d::Zero() : distributed[i],
            .log_stiffness = log_stiffness[i],
            .precurvature_per_m = precurvature[i]};
  }
  BatchLoads arrays(std::size_t first, std::size_t rods) const {
    const auto some = [&](const std::vector<Vector3d>& v) {
      return v.empty() ? std::span<const Vector3d>() : std::span(v).subspan(first, rods);
    };
    return {some(force), some(moment), some(couple), some(distributed), some(log_stiffness), some(precurvature)};
  }
  BatchLoads arrays() const { return arrays(0, force.size()); }
};

/// From none to 0.4 N, so that step counts range widely; `distributed_N_per_m` 0 leaves that array out.
inline ManyLoads random_loads(int rods, unsigned seed, double distributed_N_per_m = 0.0) {
  std::mt19937_64 random(seed);
  ManyLoads loads;
  for (int i = 0; i < rods; ++i) {
    loads.force.push_back(uniform_in_ball(random, 0.4 * (i % 10) / 9.0));
    loads.moment.push_back(uniform_in_ball(random, 3e-3));
    loads.couple.push_back(uniform_in_ball(random, 3e-3));
    loads.log_stiffness.push_back(uniform_in_ball(random, 0.3));
    loads.precurvature.push_back(uniform_in_ball(random, 20.0));
    if (distributed_N_per_m > 0.0) loads.distributed.push_back(uniform_in_ball(random, distributed_N_per_m));
  }
  return loads;
}

/// Stiff to soft to rigid, its tip rigid and touched beside the axis.
inline Rod rod_of_sections() {
  Rod rod = paper_catheter(15.0);
  Section soft = rod.sections[0], stiff = rod.sections[0], ring = rod.sections[0];
  stiff.to_m = soft.from_m = 0.02;
  soft.to_m = ring.from_m = 0.061;
  stiff.stiffness_Nm2 *= 3.0;
  stiff.precurvature_per_m = {0.0, 5.0, 1.0};
  ring.rigid = true;
  rod.sections = {stiff, soft, ring};
  rod.rigid_tip_m = 0.004;
  rod.contact_offset_m = {0.001, -0.0005, 0.004};
  return rod;
}

inline Rod shearing_rod() {
  Rod rod = rod_of_sections();
  rod.shear_stiffness_N = 300.0;
  rod.axial_stiffness_N = 900.0;
  return rod;
}

inline const std::vector<double> kPlaces_m{0.03, 0.07, 0.0, 0.074, 0.061, 0.0653, 0.03};

inline std::vector<InstructionSet> sets_here() {
  std::vector<InstructionSet> sets;
  for (const InstructionSet set : kInstructionSets)
    if (available(set)) sets.push_back(set);
  return sets;
}

/// Every number of a solution, one column a rod.
inline Eigen::MatrixXd numbers(const BatchSolution& solution) {
  std::vector<Eigen::MatrixXd> parts;
  const auto take = [&](const auto& part) {
    if (part.cols() > 0) parts.push_back(part);
  };
  const auto take_all = [&](const BatchPoints& p) {
    take(p.R_base_local), take(p.p_base_local_m), take(p.curvature_per_m);
    take(p.d_rotation), take(p.d_position_m), take(p.d_curvature_per_m);
  };
  take_all(solution.tip);
  for (const BatchPoints& station : solution.stations) take_all(station);
  Eigen::Index rows = 0;
  for (const auto& part : parts) rows += part.rows();
  Eigen::MatrixXd all(rows, solution.tip.p_base_local_m.cols());
  rows = 0;
  for (const auto& part : parts) all.middleRows(rows, part.rows()) = part, rows += part.rows();
  return all;
}

inline Eigen::MatrixXd solved(const RodSolver& solver, const BatchLoads& loads, const BatchOptions& options) {
  BatchSolution solution;
  solve_batch(solver, loads, options, solution);
  return numbers(solution);
}

}  // namespace palpate::test
