// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/identification/stiffness_steps.hpp>
#include <palpate/math/errors.hpp>

namespace palpate::stiffness {

namespace {

constexpr double kWidest = 9.21034037197618273607;  // log 1e4
constexpr double kStep = 0.76752836433134863;       // log 10 / 3
constexpr double kUnbent_rad = 0.3;                 // below, deflection is nearly linear in the load

/// Force times length squared over the least EI: by how many radians the loads bend the shaft as described, about.
double bending_rad(const Rod& rod, std::span<const LoadCase> cases) {
  double EI = std::numeric_limits<double>::infinity(), force = 0.0;
  for (const Section& section : rod.sections)
    if (!section.rigid) EI = std::min(EI, section.stiffness_Nm2.head<2>().minCoeff());
  for (const LoadCase& one : cases) force = std::max(force, one.force_base_N.norm());
  const double L = rod.length_m();
  return (force + L * rod.distributed_load_base_N_per_m.norm()) * L * L / EI;
}

struct Best {
  double log_scale = 0.0, cost = std::numeric_limits<double>::infinity();
  Problem::Start start;
};

/// Softens the shaft from `log_scale` on until the shapes suit clearly worse than they did.
Best soften(Problem& problem, double log_scale, double cost_unbent) {
  Best best;
  for (double x = log_scale; x > -kWidest - 1e-9; x -= kStep) {
    const double cost = problem.cost_at_scale(x);
    if (!std::isfinite(cost)) break;
    if (cost < best.cost) best = {x, cost, problem.start()};
    if (cost > best.cost + 0.2 * std::max(cost_unbent - best.cost, 0.0)) break;
  }
  return best;
}

/// The other way: the first scale was the best.
void stiffen(Problem& problem, Best& best) {
  for (double x = best.log_scale + kStep; x < kWidest + kStep; x += kStep) {
    const double cost = problem.cost_at_scale(x);
    if (!(cost < best.cost)) return;
    best = {x, cost, problem.start()};
  }
}

}  // namespace

double find_scale(Problem& problem, std::span<const LoadCase> cases) {
  const Rod& rod = problem.unknowns().described();
  const double bend = bending_rad(rod, cases);
  if (!(bend < 10.0 * std::exp(kWidest) && bend > 1e-4 * std::exp(-kWidest)))
    throw InputError(fmt::format(
        "the loads would bend the shaft by {:.2g} rad (force length^2 / EI): expected numbers of one setup; are the "
        "units of length, stiffness and force right?",
        bend));
  const double unbent = problem.cost_at_scale(2.0 * kWidest);
  const double first = std::clamp(std::log(bend / kUnbent_rad), -kWidest, kWidest);
  Best best = soften(problem, first, unbent);
  if (best.log_scale == first) stiffen(problem, best);
  const bool at_an_end = best.log_scale > kWidest || best.log_scale < -kWidest + 0.5 * kStep;
  if (!std::isfinite(best.cost) || at_an_end || !(best.cost < unbent))
    throw InputError(
        "no stiffness within a factor of 1e4 of the catheter file's explains the shapes better than no load at all: "
        "are the points bent, and are units and directions of loads and points right?");
  problem.set_start(best.start);
  if (!problem.sigma_stated())
    problem.set_unknown_sigma(problem.unknown_sigma_m() * std::sqrt(2.0 * best.cost / problem.measured()) +
                              1e-9 * rod.length_m());
  return best.log_scale;
}

}  // namespace palpate::stiffness
