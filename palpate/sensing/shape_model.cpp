// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <palpate/math/errors.hpp>
#include <palpate/sensing/shape_model.hpp>

namespace palpate {

namespace {

std::vector<double> arc_lengths(const Catheter& catheter) {
  std::vector<double> s;
  for (const Sensor& sensor : catheter.sensors) s.push_back(sensor.arc_length_m);
  return s;
}

/// Of the first flexible section; without one any will do, but not the zeros of a rigid one.
Stiffness nominal_stiffness(const Rod& rod) {
  const auto flexible =
      std::find_if(rod.sections.begin(), rod.sections.end(), [](const Section& s) { return !s.rigid; });
  return flexible == rod.sections.end() ? Stiffness(1.0, 1.0, 1.0) : flexible->stiffness_Nm2;
}

/// Indices of the sensors with full orientation, the most distal first.
std::vector<int> pose_sensors_from_tip(const Catheter& catheter) {
  std::vector<int> order;
  for (std::size_t i = 0; i < catheter.sensors.size(); ++i)
    if (catheter.sensors[i].kind == SensorKind::kPose) order.push_back(static_cast<int>(i));
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return catheter.sensors[a].arc_length_m > catheter.sensors[b].arc_length_m; });
  return order;
}

}  // namespace

ShapeModel::ShapeModel(const Catheter& catheter, MeasurementKind kind, const UncertainParameters& parameters,
                       Accuracy accuracy)
    : catheter_(catheter),
      kind_(kind),
      parameters_(parameters),
      rod_(catheter.rod, arc_lengths(catheter), accuracy),
      seeds_(catheter) {
  catheter_.validate();
  choose_solver();
  if (kind_ != MeasurementKind::kTipAndCurvature) return;
  const std::vector<int> order = pose_sensors_from_tip(catheter_);
  if (order.empty())
    throw InputError("measurement = \"tip_and_curvature\": expected at least one sensor of kind \"pose\"");
  tip_ = order[0];
  for (const Sensor& sensor : catheter_.sensors)
    if (sensor.arc_length_m > catheter_.sensors[tip_].arc_length_m)
      throw InputError(fmt::format(
          "measurement = \"tip_and_curvature\": sensor \"{}\": expected kind \"pose\" at the tip", sensor.name));
  if (order.size() > 1) behind_ = order[1];
  const bool two_bases =
      catheter_.base.tracked && behind_ >= 0 &&
      catheter_.sensors[tip_].T_tracker_base.has_value() != catheter_.sensors[behind_].T_tracker_base.has_value();
  if (two_bases)  // otherwise the noise of a tracked base cancels in the curvature
    throw InputError(
        fmt::format("measurement = \"tip_and_curvature\": sensors \"{}\" and \"{}\": expected a registration of "
                    "their own for both, or the tracked base for both",
                    catheter_.sensors[tip_].name, catheter_.sensors[behind_].name));
  if (behind_ >= 0 && segment_m() <= 0.0)
    throw InputError(fmt::format("measurement = \"tip_and_curvature\": sensors \"{}\" and \"{}\" share one arc length",
                                 catheter_.sensors[tip_].name, catheter_.sensors[behind_].name));
}

double ShapeModel::segment_m() const {
  return catheter_.sensors[tip_].arc_length_m - catheter_.sensors[behind_].arc_length_m;
}

void ShapeModel::choose_solver() {
  const auto choose = [&]<int N>(Solver<N>&& solver) {
    solver.solution = rod_.make_solution<N>();
    solver.workspace = make_weight_workspace<N>(rod_);
    set_directions(solver);
    solver_ = std::move(solver);
  };
  if (states() <= 3)
    choose(Solver<3>{});
  else if (states() <= 6)
    choose(Solver<6>{});
  else if (states() <= 9)
    choose(Solver<9>{});
  else
    choose(Solver<12>{});
}

void ShapeModel::select(const Measurement& measurement, unsigned mask) {
  measurement_ = &measurement;
  selected_count_ = rows_ = 0;
  curvature_ = known_ = false;
  used_ = 0;
  if (kind_ == MeasurementKind::kTipAndCurvature)
    select_tip_and_curvature(measurement, mask);
  else
    for (int k = 0; k < measurement.count; ++k)
      if (mask >> measurement.poses[k].sensor & 1U) add_sensor(measurement.poses[k]);
  if (!known_load_.present || rows_ == 0) return;
  known_ = true;
  for (int i = 0; i < 3; ++i) channels_[rows_ + i] = 6 * kMaxSensors + 3 + i;
  rows_ += 3;
}

void ShapeModel::add_sensor(const Measurement::SensorPose& pose) {
  const int count = rows_of(catheter_.sensors[pose.sensor].kind);
  for (int i = 0; i < count; ++i) channels_[rows_ + i] = 6 * pose.sensor + i;
  selected_[selected_count_++] = {&pose, rows_};
  rows_ += count;
  used_ |= 1U << pose.sensor;
}

void ShapeModel::select_tip_and_curvature(const Measurement& measurement, unsigned mask) {
  const Measurement::SensorPose *tip = nullptr, *behind = nullptr;
  for (int k = 0; k < measurement.count; ++k) {
    const Measurement::SensorPose& pose = measurement.poses[k];
    if (!(mask >> pose.sensor & 1U)) continue;
    if (pose.sensor == tip_) tip = &pose;
    if (pose.sensor == behind_) behind = &pose;
  }
  if (!tip) return;
  add_sensor(*tip);
  if (!behind) return;
  curvature_ = true;
  selected_[selected_count_] = {behind, rows_};  // its orientation enters through the curvature rows alone
  for (int i = 0; i < 3; ++i) channels_[rows_ + i] = 6 * kMaxSensors + i;
  rows_ += 3;
  used_ |= 1U << behind_;
}

void ShapeModel::set_bend(const BendReading& bend) {
  if (!bend.change_per_m.allFinite()) return;
  bend_per_m_.head<2>() = bend.change_per_m;
  for (int axis = 0; axis < 2; ++axis) {
    const int p = parameters_.find(ParameterKind::kPrecurvature, axis);
    if (p < 0 || parameters_.all[p].estimated) continue;
    const double sigma_per_m = bend.sigma_per_m(axis), known_per_m = std::sqrt(parameters_.covariance(p, p));
    const bool stated = sigma_per_m > 0.0 && std::isfinite(sigma_per_m);
    bend_spread_(axis) = stated ? sigma_per_m / known_per_m : 1.0;
  }
}

/// Tendon, stiffness and precurvature at x, each the catheter file's with the deviation on top.
void ShapeModel::set_load(const StateVector& x) {
  Vector3d log_scale = Vector3d::Zero();
  load_.log_stiffness.setZero();
  load_.precurvature_per_m = bend_per_m_;
  Vector3d tendon_Nm = tendon_Nm_;
  tendon_scale_ = 1.0;
  for (int i = 0; i < parameters_.rod_count; ++i) {
    const UncertainParameter& p = parameters_.all[i];
    const double value = x(3 + i);
    if (p.kind == ParameterKind::kLogStiffness) load_.log_stiffness(p.axis) = value;
    log_scale += value * force_exponent(p);
    if (p.kind == ParameterKind::kPrecurvature) load_.precurvature_per_m(p.axis) += bend_spread_(p.axis) * value;
    if (p.kind == ParameterKind::kTendonScale) tendon_scale_ = std::exp(value);
    if (p.kind == ParameterKind::kTendonMoment) tendon_Nm(p.axis) += value;
  }
  force_scale_ = log_scale.array().exp();
  load_.force_tip_N = force_scale_.cwiseProduct(x.head<3>());
  if (parameters_.torsion_tied) {
    const Stiffness K = nominal_stiffness(catheter_.rod);
    const double EI1 = K(0) * std::exp(load_.log_stiffness(0)), EI2 = K(1) * std::exp(load_.log_stiffness(1));
    load_.log_stiffness(2) = std::log((EI1 + EI2) / (K(0) + K(1)));
    torsion_by_bending_ = Eigen::Vector2d(EI1, EI2) / (EI1 + EI2);
  }
  const bool couple = catheter_.tendon.model == TendonModel::kCouple;
  (couple ? load_.tendon_couple_Nm : load_.moment_tip_Nm) = tendon_scale_ * tendon_Nm;
}

/// What changes from one x, or one frame, to the next: a column a parameter.
template <int N>
void ShapeModel::set_directions(Solver<N>& solver) const {
  LoadDirections<N>& d = solver.directions;
  d.force_tip_N.template leftCols<3>() = force_scale_.asDiagonal();
  const bool couple = catheter_.tendon.model == TendonModel::kCouple;
  auto& moment = couple ? d.tendon_couple_Nm : d.moment_tip_Nm;
  for (int i = 0; i < parameters_.rod_count; ++i) {
    const UncertainParameter& p = parameters_.all[i];
    d.force_tip_N.col(3 + i) = force_exponent(p).cwiseProduct(load_.force_tip_N);
    if (p.kind == ParameterKind::kLogStiffness) {
      d.log_stiffness(p.axis, 3 + i) = 1.0;
      if (parameters_.torsion_tied) d.log_stiffness(2, 3 + i) = torsion_by_bending_(p.axis);
    }
    if (p.kind == ParameterKind::kPrecurvature) d.precurvature_per_m(p.axis, 3 + i) = bend_spread_(p.axis);
    if (p.kind == ParameterKind::kTendonScale)
      moment.col(3 + i) = couple ? load_.tendon_couple_Nm : load_.moment_tip_Nm;
    if (p.kind == ParameterKind::kTendonMoment) moment(p.axis, 3 + i) = tendon_scale_;
  }
}

bool ShapeModel::linearize(const StateVector& x, Linearization& at) {
  if (!x.allFinite()) return false;
  x_ = x;
  set_load(x);
  return std::visit([&](auto& solver) { return linearize(solver, at); }, solver_);
}

template <int N>
bool ShapeModel::linearize(Solver<N>& solver, Linearization& at) {
  set_directions(solver);
  const WeightedSolve solve = solve_under_weight(rod_, load_, solver.directions, solver.workspace, solver.solution);
  evaluations_ += solve.evaluations;
  T_base_tip_ = solver.solution.T_base_tip;
  if (!solve.converged) return false;
  at.residual.resize(rows_);
  at.jacobian.resize(rows_, states());
  for (int k = 0; k < selected_count_; ++k) {
    const Measurement::SensorPose& measured = *selected_[k].measured;
    const Sensor& sensor = catheter_.sensors[measured.sensor];
    append_sensor_rows(
        sensor.kind,
        predict_sensor(sensor, solver.solution.points[measured.sensor], solver.solution.tangents[measured.sensor]),
        measured.T_base_sensor, selected_[k].first, at);
  }
  if (curvature_) curvature_rows(solver.solution, at);
  if (known_) known_load_rows(solver, at);
  return at.residual.allFinite();
}

Matrix3d ShapeModel::R_base_tip_near(const StateVector& x) const {
  const StateVector step = x - x_;
  const Vector3d phi = std::visit(
      [&](const auto& solver) -> Vector3d { return solver.solution.tip_rotation.leftCols(step.size()) * step; },
      solver_);
  return T_base_tip_.R * exp_so3(phi);
}

int ShapeModel::block_end(int row) const {
  int end = rows_;
  if (known_) {
    if (row >= known_row()) return end;
    end = known_row();
  }
  for (int k = selected_count_ - 1 + (curvature_ ? 1 : 0); k >= 0 && selected_[k].first > row; --k)
    end = selected_[k].first;
  return end;
}

bool ShapeModel::seed(int k, StateVector& x, int& evaluations) {
  set_load(x);  // the latest search may have ended with a shaft that is nothing like the one to start from
  if (k == 0) {
    TipLoad load = load_;
    load.distributed_tip_N_per_m =
        T_base_tip_.R.transpose() * catheter_.rod.distributed_load_base_N_per_m;  // as of the latest shape
    seeds_.begin(*measurement_, used_, load);
  }
  const std::int64_t before = seeds_.evaluations();
  Vector3d force_tip_N;
  const bool found = seeds_.seed(k, force_tip_N);
  const std::int64_t work = seeds_.evaluations() - before;
  evaluations += static_cast<int>(work);
  evaluations_ += work;
  if (found && force_tip_N.allFinite()) x.head<3>() = force_tip_N.cwiseQuotient(force_scale_);
  return found;
}

/// omega_se = log(R_behind^T R_tip) / ds in local axes (Eq. (11)), measured and predicted alike, so that the finite
/// segment biases neither. d omega = (J_r^-1 phi_tip - J_l^-1 phi_behind) / ds.
template <int N>
void ShapeModel::curvature_rows(const RodSolution<N>& solution, Linearization& at) const {
  const Row& row = selected_[selected_count_];
  const Matrix3d &mount_tip = catheter_.sensors[tip_].T_local_sensor.R,
                 &mount_behind = catheter_.sensors[behind_].T_local_sensor.R;
  const Matrix3d R_tip = selected_[0].measured->T_base_sensor.R * mount_tip.transpose();
  const Matrix3d R_behind = row.measured->T_base_sensor.R * mount_behind.transpose();
  const Matrix3d& P_tip = solution.points[tip_].T_base_local.R;
  const Matrix3d& P_behind = solution.points[behind_].T_base_local.R;
  const double ds = segment_m();
  const Vector3d turn = log_so3(P_behind.transpose() * P_tip);
  at.residual.segment<3>(row.first) = (log_so3(R_behind.transpose() * R_tip) - turn) / ds;
  const Eigen::Matrix<double, 3, N> d = inverse_right_jacobian(turn) * solution.tangents[tip_].rotation -
                                        inverse_left_jacobian(turn) * solution.tangents[behind_].rotation;
  at.jacobian.middleRows<3>(row.first) = d.leftCols(states()) / ds;
}

/// F_known - F, in the components in which it is known; d(R F) = R (dF + phi x F).
template <int N>
void ShapeModel::known_load_rows(const Solver<N>& solver, Linearization& at) const {
  const Vector3d& F = load_.force_tip_N;
  const Matrix3d R = known_load_.in_base ? T_base_tip_.R : Matrix3d::Identity();
  at.residual.segment<3>(known_row()) = known_load_.force_N - R * F;
  Eigen::Matrix<double, 3, N> d = R * solver.directions.force_tip_N;
  if (known_load_.in_base) d -= R * hat(F) * solver.solution.tip_rotation;
  at.jacobian.middleRows<3>(known_row()) = d.leftCols(states());
}

}  // namespace palpate
