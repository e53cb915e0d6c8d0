// SPDX-License-Identifier: Apache-2.0
#include <palpate/evaluation/shown_shape.hpp>
#include <vector>

namespace palpate {

namespace {

std::vector<double> stations(const Catheter& catheter, int points) {
  const double length_m = catheter.rod.length_m() + catheter.rod.rigid_tip_m;
  std::vector<double> at_m;
  at_m.reserve(static_cast<std::size_t>(points) + catheter.sensors.size());
  for (int i = 0; i < points; ++i) at_m.push_back(length_m * i / (points - 1));
  for (const Sensor& sensor : catheter.sensors) at_m.push_back(sensor.arc_length_m);
  return at_m;
}

}  // namespace

ShownShape::ShownShape(const Catheter& catheter, int points)
    : shaft_(catheter.rod.first_flexible()),
      tendon_model_(catheter.tendon.model),
      solver_(catheter.rod, stations(catheter, points)),
      workspace_(make_weight_workspace<3>(solver_)),
      solution_(solver_.make_solution<3>()) {}

const RodSolution<3>& ShownShape::solve(const TrackerFrame& frame, const EstimateRow& row) {
  solve_under_weight<3>(solver_, load(frame, row), {}, workspace_, solution_);
  return solution_;
}

TipLoad ShownShape::load(const TrackerFrame& frame, const EstimateRow& row) const {
  TipLoad load{.force_tip_N = row.force_tip_N};
  if (row.shaft.stiffness_Nm2(0) > 0.0 && row.shaft.stiffness_Nm2(1) > 0.0 && !shaft_.rigid) {
    Vector3d share = row.shaft.stiffness_Nm2.cwiseQuotient(shaft_.stiffness_Nm2);
    if (!(share(2) > 0.0)) share(2) = 0.5 * (share(0) + share(1));
    load.log_stiffness = share.array().log();
  }
  if (!row.shaft.precurvature_per_m.isZero(0.0))  // the handle's bend is in it
    load.precurvature_per_m.head<2>() = (row.shaft.precurvature_per_m - shaft_.precurvature_per_m).head<2>();
  else if (frame.bend.present)
    load.precurvature_per_m.head<2>() = frame.bend.change_per_m;
  if (frame.tendon.present) {
    const bool couple = tendon_model_ == TendonModel::kCouple;
    (couple ? load.tendon_couple_Nm : load.moment_tip_Nm).head<2>() = frame.tendon.moment_Nm;
  }
  return load;
}

}  // namespace palpate
