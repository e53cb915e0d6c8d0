// SPDX-License-Identifier: Apache-2.0
#include <palpate/batch/plan.hpp>
#include <palpate/rod/step_rule.hpp>

namespace palpate::rod_lanes {
namespace {

void set(const Vector3d& v, double* out) {
  for (int i = 0; i < 3; ++i) out[i] = v[i];
}

void set(const Vector3d& v, int lane, Row* rows) {
  for (int i = 0; i < 3; ++i) rows[i][lane] = v[i];
}

/// Stations count from 0 in the solver; before them stands the flexible end.
Piece piece_of(const RodSolver& solver, const RodSolver::Piece& piece) {
  const Section& section = solver.rod().sections[piece.section];
  Piece out{.from_sigma_m = piece.from_sigma_m,
            .length_m = piece.length_m,
            .stiffness_Nm2 = {},
            .precurvature_per_m = {},
            .rigid = section.rigid,
            .first_point = piece.first_station + 1,
            .end_point = piece.end_station + 1};
  set(section.stiffness_Nm2, out.stiffness_Nm2);
  set(section.precurvature_per_m, out.precurvature_per_m);
  return out;
}

}  // namespace

SolverPlan::SolverPlan(const RodSolver& solver) : beyond_m_{0.0} {
  const Rod& rod = solver.rod();
  for (const RodSolver::Piece& piece : solver.pieces()) pieces_.push_back(piece_of(solver, piece));
  const int at_tip = pieces_.front().first_point;
  for (int k = 0; k + 1 < at_tip; ++k) {
    const double beyond_m = solver.arc_lengths_m()[solver.station_order()[k]] - rod.length_m();
    beyond_m_.push_back(beyond_m < 1e-12 * rod.length_m() ? 0.0 : beyond_m);
  }
  plan_.pieces = pieces_.data();
  plan_.piece_count = static_cast<int>(pieces_.size());
  plan_.beyond_m = beyond_m_.data();
  plan_.points_at_tip = at_tip;
  plan_.point_count = 1 + static_cast<int>(solver.station_order().size());
  set(rod.contact_offset_m, plan_.contact_offset_m);
  if (rod.shears())
    set({1.0 / rod.shear_stiffness_N, 1.0 / rod.shear_stiffness_N, 1.0 / rod.axial_stiffness_N},
        plan_.shear_compliance);
}

void step_counts(const Plan& plan, const StepRule& rule, double curvature_per_m, int lane, Row* steps) {
  for (int i = 0; i < plan.piece_count; ++i) {
    const Steps piece = steps_over(plan.pieces[i].length_m * curvature_per_m, i == 0, rule);
    steps[i][lane] = piece.sixth_order ? kOneOfOrder6 : piece.count;
  }
}

int total_steps(const Plan& plan, const StepRule& rule, double curvature_per_m) {
  int total = 0;
  for (int i = 0; i < plan.piece_count; ++i)
    total += steps_over(plan.pieces[i].length_m * curvature_per_m, i == 0, rule).count;
  return total;
}

void set_lane(const RodSolver& solver, const TipLoad& load, int lane, Loads& loads) {
  set(load.force_tip_N, lane, loads.force_N);
  set(load.moment_tip_Nm + solver.rod().contact_offset_m.cross(load.force_tip_N), lane, loads.moment_Nm);
  set(load.tendon_couple_Nm, lane, loads.couple_Nm);
  set(load.distributed_tip_N_per_m, lane, loads.distributed_N_per_m);
  set(compliance_factor(load), lane, loads.compliance_factor);
  set(load.precurvature_per_m, lane, loads.precurvature_per_m);
}

}  // namespace palpate::rod_lanes
