// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/batch/kernel.hpp>
#include <palpate/rod/statics.hpp>
#include <vector>

namespace palpate::rod_lanes {

/// A RodSolver as the kernels want it, and the order of its points.
class SolverPlan {
 public:
  explicit SolverPlan(const RodSolver& solver);
  SolverPlan(const SolverPlan&) = delete;
  SolverPlan& operator=(const SolverPlan&) = delete;

  const Plan& plan() const { return plan_; }

 private:
  std::vector<Piece> pieces_;
  std::vector<double> beyond_m_;
  Plan plan_{};
};

/// Steps that RodSolver::solve() takes under a load of this curvature bound: of each piece, as a kernel reads them, and
/// together.
void step_counts(const Plan& plan, const StepRule& rule, double curvature_per_m, int lane, Row* steps);
int total_steps(const Plan& plan, const StepRule& rule, double curvature_per_m);

/// Writes `load` into a lane.
void set_lane(const RodSolver& solver, const TipLoad& load, int lane, Loads& loads);

}  // namespace palpate::rod_lanes
