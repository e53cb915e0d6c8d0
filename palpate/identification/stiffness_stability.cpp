// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/identification/stiffness_steps.hpp>

namespace palpate::stiffness {

namespace {

// det(dF_base/dF_tip) is 1 for the unloaded shaft and passes zero where stability is lost. A path on which it never
// fell so far has met no bifurcation; the small steps of follow_from_rest() would cost more than the whole fit.
constexpr double kSurelyStable = 0.2;
constexpr double kSameShape_rad = 1e-3;

/// The shaft as the case at q sees it: all in clamp axes.
Rod shaft_at(const Problem& problem, const Eigen::VectorXd& z) {
  const Numbers q = problem.unknowns().numbers(z);
  Rod rod = problem.unknowns().identified(z);
  rod.distributed_load_base_N_per_m = exp_so3(q.segment<3>(kTurn)).transpose() * rod.distributed_load_base_N_per_m;
  for (Section& section : rod.sections)
    if (!section.rigid) section.precurvature_per_m += q.segment<3>(kPrecurvature);
  return rod;
}

}  // namespace

bool check_stability(Problem& problem, const Eigen::VectorXd& z, std::vector<std::string>& warnings) {
  const Numbers q = problem.unknowns().numbers(z);
  bool moved = false;
  for (CaseModel& one : problem.cases()) {
    if (one.loaded().start().least_determinant > kSurelyStable) continue;
    const RodSolver solver(shaft_at(problem, z), std::vector<double>{}, Accuracy::kReference);
    const Vector3d force = exp_so3(q.segment<3>(kTurn)).transpose() * one.load_case().force_base_N;
    const Equilibrium equilibrium = follow_from_rest(solver, {.force_base_N = force, .tip = {}});
    if (equilibrium.status != EquilibriumStatus::kStable)
      warnings.push_back(
          fmt::format("load case {}: the shaft loses its stability at {:.0f} % of this load: its shape may be another "
                      "one than the model's; leave the case out",
                      one.load_case().name, 100.0 * equilibrium.critical_load_factor));
    if (equilibrium.load_factor < 1.0) continue;
    const Matrix3d R_tip_base = equilibrium.T_base_tip.R.transpose();
    if (log_so3(R_tip_base.transpose() * one.loaded().start().R_tip_base).norm() < kSameShape_rad) continue;
    one.loaded().restart(q, R_tip_base);
    moved = true;
  }
  if (moved) problem.leave_branch();
  return moved;
}

}  // namespace palpate::stiffness
