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

ShapeModel::ShapeModel(const Catheter& catheter, MeasurementKind kind, Accuracy accuracy)
    : catheter_(catheter),
      kind_(kind),
      solver_(catheter.rod, arc_lengths(catheter), accuracy),
      solution_(solver_.make_solution<3>()),
      workspace_(make_weight_workspace<3>(solver_)),
      seeds_(catheter) {
  catheter_.validate();
  directions_.force_tip_N.setIdentity();
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

void ShapeModel::set_tendon_moment(const Eigen::Vector2d& moment_Nm) {
  const Vector3d moment(moment_Nm.x(), moment_Nm.y(), 0.0);
  const bool couple = catheter_.tendon.model == TendonModel::kCouple;
  (couple ? load_.tendon_couple_Nm : load_.moment_tip_Nm) = moment;
}

void ShapeModel::select(const Measurement& measurement, unsigned mask) {
  measurement_ = &measurement;
  selected_count_ = rows_ = 0;
  curvature_ = false;
  used_ = 0;
  if (kind_ == MeasurementKind::kTipAndCurvature) return select_tip_and_curvature(measurement, mask);
  for (int k = 0; k < measurement.count; ++k)
    if (mask >> measurement.poses[k].sensor & 1U) add_sensor(measurement.poses[k]);
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

void ShapeModel::noise(ResidualMatrix& R) const {
  R.setZero(rows_, rows_);
  for (int k = 0; k < selected_count_; ++k) {
    const Sensor& sensor = catheter_.sensors[selected_[k].measured->sensor];
    const int first = selected_[k].first, turns = rows_of(sensor.kind) - 3;
    R.diagonal().segment<3>(first) = sensor.noise_m.cwiseAbs2();
    R.diagonal().segment(first + 3, turns).setConstant(sensor.noise_rad * sensor.noise_rad);
  }
  if (curvature_) curvature_noise(R);
  if (catheter_.base.tracked) add_base_noise(R);
}

bool ShapeModel::linearize(const StateVector& x, Linearization& at) {
  load_.force_tip_N = x.head<3>();
  if (!load_.force_tip_N.allFinite()) return false;
  const WeightedSolve solve = solve_under_weight(solver_, load_, directions_, workspace_, solution_);
  evaluations_ += solve.evaluations;
  if (!solve.converged) return false;
  at.residual.resize(rows_);
  at.jacobian.resize(rows_, 3);
  for (int k = 0; k < selected_count_; ++k) {
    const Measurement::SensorPose& measured = *selected_[k].measured;
    const Sensor& sensor = catheter_.sensors[measured.sensor];
    append_sensor_rows(sensor.kind,
                       predict_sensor(sensor, solution_.points[measured.sensor], solution_.tangents[measured.sensor]),
                       measured.T_base_sensor, selected_[k].first, at);
  }
  if (curvature_) curvature_rows(at);
  return at.residual.allFinite();
}

int ShapeModel::block_end(int row) const {
  int end = rows_;
  for (int k = selected_count_ - 1 + (curvature_ ? 1 : 0); k >= 0 && selected_[k].first > row; --k)
    end = selected_[k].first;
  return end;
}

bool ShapeModel::seed(int k, StateVector& x, int& evaluations) {
  if (k == 0) {
    TipLoad load = load_;
    load.distributed_tip_N_per_m =
        solution_.T_base_tip.R.transpose() * catheter_.rod.distributed_load_base_N_per_m;  // as of the latest shape
    seeds_.begin(*measurement_, used_, load);
  }
  const std::int64_t before = seeds_.evaluations();
  Vector3d force_tip_N;
  const bool found = seeds_.seed(k, force_tip_N);
  const std::int64_t work = seeds_.evaluations() - before;
  evaluations += static_cast<int>(work);
  evaluations_ += work;
  if (found && force_tip_N.allFinite()) x.head<3>() = force_tip_N;
  return found;
}

/// omega_se = log(R_behind^T R_tip) / ds in local axes (Eq. (11)), measured and predicted alike, so that the finite
/// segment biases neither. d omega = (J_r^-1 phi_tip - J_l^-1 phi_behind) / ds.
void ShapeModel::curvature_rows(Linearization& at) const {
  const Row& row = selected_[selected_count_];
  const Matrix3d &mount_tip = catheter_.sensors[tip_].T_local_sensor.R,
                 &mount_behind = catheter_.sensors[behind_].T_local_sensor.R;
  const Matrix3d R_tip = selected_[0].measured->T_base_sensor.R * mount_tip.transpose();
  const Matrix3d R_behind = row.measured->T_base_sensor.R * mount_behind.transpose();
  const Matrix3d& P_tip = solution_.points[tip_].T_base_local.R;
  const Matrix3d& P_behind = solution_.points[behind_].T_base_local.R;
  const double ds = segment_m();
  const Vector3d turn = log_so3(P_behind.transpose() * P_tip);
  at.residual.segment<3>(row.first) = (log_so3(R_behind.transpose() * R_tip) - turn) / ds;
  at.jacobian.block<3, 3>(row.first, 0) = (inverse_right_jacobian(turn) * solution_.tangents[tip_].rotation -
                                           inverse_left_jacobian(turn) * solution_.tangents[behind_].rotation) /
                                          ds;
}

/// The paper takes curvature and pose as independent; they share the tip's orientation noise, which counts here.
void ShapeModel::curvature_noise(ResidualMatrix& R) const {
  const Row& row = selected_[selected_count_];
  const Sensor &tip = catheter_.sensors[tip_], &behind = catheter_.sensors[behind_];
  const Matrix3d R_tip = selected_[0].measured->T_base_sensor.R * tip.T_local_sensor.R.transpose();
  const Matrix3d R_behind = row.measured->T_base_sensor.R * behind.T_local_sensor.R.transpose();
  const Vector3d turn = log_so3(R_behind.transpose() * R_tip);
  const Matrix3d by_tip = inverse_right_jacobian(turn) / segment_m(),
                 by_behind = inverse_left_jacobian(turn) / segment_m();
  const double tip_variance = tip.noise_rad * tip.noise_rad, behind_variance = behind.noise_rad * behind.noise_rad;
  R.block<3, 3>(row.first, row.first) =
      tip_variance * by_tip * by_tip.transpose() + behind_variance * by_behind * by_behind.transpose();
  const Matrix3d shared = tip_variance * by_tip * tip.T_local_sensor.R;
  R.block<3, 3>(row.first, selected_[0].first + 3) = shared;
  R.block<3, 3>(selected_[0].first + 3, row.first) = shared.transpose();
}

/// A tracked base is measured with noise too, and all sensors share it but those with a registration of their own: the
/// base moved by the twist (rho, theta) moves every pose in it by -rho + p x theta and -R^T theta.
void ShapeModel::add_base_noise(ResidualMatrix& R) const {
  const Sensor& base = catheter_.base.sensor;
  const Pose& mount = base.T_local_sensor;
  Eigen::Matrix<double, Eigen::Dynamic, 6, 0, kMaxResiduals, 6> B;
  B.setZero(rows_, 6);
  for (int k = 0; k < selected_count_; ++k) {
    const Sensor& sensor = catheter_.sensors[selected_[k].measured->sensor];
    if (sensor.T_tracker_base) continue;
    const Pose& T = selected_[k].measured->T_base_sensor;
    const int first = selected_[k].first, turns = rows_of(sensor.kind) - 3;
    B.block<3, 3>(first, 0).diagonal() = -base.noise_m;  // along the base axes, as for every sensor
    B.block<3, 3>(first, 3) = hat(T.p - mount.p) * mount.R * base.noise_rad;
    B.block(first + 3, 3, turns, 3) = (-T.R.transpose() * mount.R * base.noise_rad).topRows(turns);
  }
  R.noalias() += B.lazyProduct(B.transpose());
}

}  // namespace palpate
