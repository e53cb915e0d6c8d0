// SPDX-License-Identifier: Apache-2.0
#include <palpate/identification/registration_model.hpp>

namespace palpate {

namespace {

std::vector<double> arc_lengths_of(const Catheter& catheter) {
  std::vector<double> arc_lengths_m;
  for (const Sensor& sensor : catheter.sensors) arc_lengths_m.push_back(sensor.arc_length_m);
  return arc_lengths_m;
}

}  // namespace

RegistrationModel::RegistrationModel(const Catheter& catheter, std::span<const KnobPosition> positions, bool mounting)
    : catheter_(catheter),
      mounting_(mounting),
      positions_(static_cast<int>(positions.size())),
      solver_(catheter.rod, arc_lengths_of(catheter), Accuracy::kReference),
      shape_(solver_.make_solution<3>()),
      workspace_(make_weight_workspace<3>(solver_)) {
  for (int j = 0; j < positions_; ++j) {
    for (int i = 0; i < sensors(); ++i) {
      const MeanPose& mean = positions[static_cast<std::size_t>(j)].poses[static_cast<std::size_t>(i)];
      const Sensor& sensor = catheter_.sensors[static_cast<std::size_t>(i)];
      if (mean.count == 0 || sensor.T_tracker_base) continue;
      readings_.push_back({j, i, rows_, rows_of(sensor.kind), &mean});
      rows_ += rows_of(sensor.kind);
    }
  }
}

RegistrationState RegistrationModel::stated() const {
  RegistrationState state;
  state.bend_change_per_m.assign(static_cast<std::size_t>(positions_), Eigen::Vector2d::Zero());
  for (const Sensor& sensor : catheter_.sensors) state.T_local_sensor.push_back(sensor.T_local_sensor);
  return state;
}

RegistrationState RegistrationModel::step(const RegistrationState& from, const Eigen::VectorXd& x) const {
  RegistrationState to = from;
  to.T_reference_base = from.T_reference_base * Pose{exp_so3(x.segment<3>(3)), x.head<3>()};
  to.twist_change_per_m += x(kTwistColumn);
  for (int j = 0; j < positions_; ++j)
    to.bend_change_per_m[static_cast<std::size_t>(j)] += x.segment<2>(bend_column(j));
  for (int i = 0; mounting_ && i < sensors(); ++i) {
    Pose& mount = to.T_local_sensor[static_cast<std::size_t>(i)];
    mount.p += x.segment<3>(mount_column(i));
    mount.R = exp_so3(x.segment<3>(mount_column(i) + 3)) * mount.R;
  }
  return to;
}

bool RegistrationModel::solve(const Vector3d& precurvature_change_per_m) {
  TipLoad load;
  load.precurvature_per_m = precurvature_change_per_m;
  LoadDirections<3> directions;
  directions.precurvature_per_m.setIdentity();
  return solve_under_weight(solver_, load, directions, workspace_, shape_).converged;
}

bool RegistrationModel::evaluate(const RegistrationState& from, const Eigen::VectorXd& x, Evaluation& at) {
  at.residual.setZero(rows_);
  at.jacobian.setZero(rows_, unknowns());
  const RegistrationState to = step(from, x);
  int solved = -1;
  for (const RegistrationReading& reading : readings_) {
    const Eigen::Vector2d& bend = to.bend_change_per_m[static_cast<std::size_t>(reading.position)];
    if (reading.position != solved && !solve({bend.x(), bend.y(), to.twist_change_per_m})) return false;
    solved = reading.position;
    add_reading(reading, from, to, x, at);
  }
  return at.residual.allFinite();
}

/// T_ref_sensor = T_ref_base T_base_local T_mount; every factor turns all that stands right of it.
void RegistrationModel::add_reading(const RegistrationReading& reading, const RegistrationState& from,
                                    const RegistrationState& to, const Eigen::VectorXd& x, Evaluation& at) const {
  const auto i = static_cast<std::size_t>(reading.sensor);
  Sensor sensor = catheter_.sensors[i];
  sensor.T_local_sensor = to.T_local_sensor[i];
  const PredictedSensor<3> own = predict_sensor(sensor, shape_.points[i], shape_.tangents[i]);
  const Pose& T_base = to.T_reference_base;
  const Pose T = T_base * own.T_base_sensor;

  Eigen::MatrixXd position = Eigen::MatrixXd::Zero(3, unknowns()), rotation = position;
  const Matrix3d turn = right_jacobian(x.segment<3>(3));
  position.leftCols<3>() = from.T_reference_base.R;
  position.middleCols<3>(3) = -T_base.R * hat(own.T_base_sensor.p) * turn;
  rotation.middleCols<3>(3) = own.T_base_sensor.R.transpose() * turn;
  const int bend = bend_column(reading.position);
  position.middleCols<2>(bend) = T_base.R * own.position_m.leftCols<2>();
  rotation.middleCols<2>(bend) = own.rotation.leftCols<2>();
  position.col(kTwistColumn) = T_base.R * own.position_m.col(2);
  rotation.col(kTwistColumn) = own.rotation.col(2);
  if (mounting_) {
    const int mount = mount_column(reading.sensor);
    position.middleCols<3>(mount) = T_base.R * shape_.points[i].T_base_local.R;
    rotation.middleCols<3>(mount + 3) = from.T_local_sensor[i].R.transpose() * right_jacobian(x.segment<3>(mount + 3));
  }
  const Pose& measured = reading.mean->T_base_sensor;
  at.residual.segment<3>(reading.first_row) = measured.p - T.p;
  at.jacobian.middleRows<3>(reading.first_row) = position;
  if (reading.rows == 3) return;
  const OrientationResidual r = orientation_residual(sensor.kind, T.R, measured.R);
  at.residual.segment(reading.first_row + 3, reading.rows - 3) = r.value;
  at.jacobian.middleRows(reading.first_row + 3, reading.rows - 3) = r.D * rotation;
}

std::vector<Pose> RegistrationModel::unloaded_shape(const Vector3d& precurvature_change_per_m,
                                                    const RegistrationState& state) {
  std::vector<Pose> poses;
  if (!solve(precurvature_change_per_m)) return poses;
  for (std::size_t i = 0; i < state.T_local_sensor.size(); ++i)
    poses.push_back(shape_.points[i].T_base_local * state.T_local_sensor[i]);
  return poses;
}

}  // namespace palpate
