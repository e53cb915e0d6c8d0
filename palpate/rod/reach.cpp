// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <palpate/rod/reach.hpp>

namespace palpate {

bool within_reach(const RodSolver& solver, double curvature_bound_per_m) {
  const double most_rad = rod_lanes::kMostSteps * solver.step_rule().angle;
  return std::all_of(solver.pieces().begin(), solver.pieces().end(),
                     [&](const RodSolver::Piece& piece) { return piece.length_m * curvature_bound_per_m <= most_rad; });
}

bool within_reach(const RodSolver& solver, const TipLoad& load) {
  return within_reach(solver, solver.curvature_bound_per_m(load));
}

}  // namespace palpate
