// SPDX-License-Identifier: Apache-2.0
#include <palpate/sensing/shape_model.hpp>

/// How errors of the measured poses enter the rows of a frame: white noise, and those that last.
namespace palpate {

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
  if (known_) R.diagonal().tail<3>().setConstant(known_load_.sigma_N * known_load_.sigma_N);
}

/// d omega by a turn of the tip's and of the other sensor, each on its body side.
struct ShapeModel::CurvatureErrors {
  Matrix3d by_tip, by_behind;
};

ShapeModel::CurvatureErrors ShapeModel::curvature_errors() const {
  const Matrix3d &mount_tip = catheter_.sensors[tip_].T_local_sensor.R,
                 &mount_behind = catheter_.sensors[behind_].T_local_sensor.R;
  const Matrix3d R_tip = selected_[0].measured->T_base_sensor.R * mount_tip.transpose();
  const Matrix3d R_behind = selected_[selected_count_].measured->T_base_sensor.R * mount_behind.transpose();
  const Vector3d turn = log_so3(R_behind.transpose() * R_tip);
  return {inverse_right_jacobian(turn) * mount_tip / segment_m(),
          -inverse_left_jacobian(turn) * mount_behind / segment_m()};
}

/// The paper takes curvature and pose as independent; they share the tip's orientation noise, which counts here.
void ShapeModel::curvature_noise(ResidualMatrix& R) const {
  const int first = selected_[selected_count_].first, tip_rotation = selected_[0].first + 3;
  const CurvatureErrors errors = curvature_errors();
  const double tip = catheter_.sensors[tip_].noise_rad, behind = catheter_.sensors[behind_].noise_rad;
  R.block<3, 3>(first, first) = tip * tip * errors.by_tip * errors.by_tip.transpose() +
                                behind * behind * errors.by_behind * errors.by_behind.transpose();
  R.block<3, 3>(first, tip_rotation) = tip * tip * errors.by_tip;
  R.block<3, 3>(tip_rotation, first) = tip * tip * errors.by_tip.transpose();
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

/// Derivatives of all rows by errors of one measured pose: its position in base axes, its rotation on the body side.
struct ShapeModel::SensorErrors {
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, kMaxResiduals, 3> by_position, by_rotation;
};

ShapeModel::SensorErrors ShapeModel::errors_of(const Row& row) const {
  const Sensor& sensor = catheter_.sensors[row.measured->sensor];
  SensorErrors errors;
  errors.by_position.setZero(rows_, 3);
  errors.by_rotation.setZero(rows_, 3);
  const bool only_curvature = curvature_ && &row == &selected_[selected_count_];
  if (!only_curvature) {
    const int turns = rows_of(sensor.kind) - 3;
    errors.by_position.middleRows<3>(row.first).setIdentity();
    errors.by_rotation.middleRows(row.first + 3, turns).setIdentity();  // pose5: but the turn about its z
  }
  if (!curvature_) return errors;
  const int first = selected_[selected_count_].first;
  const CurvatureErrors curvature = curvature_errors();
  errors.by_rotation.middleRows<3>(first) = only_curvature ? curvature.by_behind : curvature.by_tip;
  return errors;
}

namespace {

/// Where a mounting error points: along the sensor's local axes, as measured. Nobody knows those of a mere point; the
/// base axes will do, for the sigma is alike along all.
Matrix3d local_axes(const Sensor& sensor, const Pose& T_base_sensor) {
  if (sensor.kind == SensorKind::kPosition) return Matrix3d::Identity();
  return T_base_sensor.R * sensor.T_local_sensor.R.transpose();
}

}  // namespace

/// Each parameter shifts the pose of one sensor, or, as the clamp's, of all that are measured from it: a base turned by
/// theta and moved by rho shows every pose moved by rho + theta x (p - p_mount) and turned by R^T theta.
void ShapeModel::pose_errors(PoseErrorMatrix& B) const {
  B.setZero(rows_, parameters_.pose_count());
  const Vector3d pivot = catheter_.base.tracked ? catheter_.base.sensor.T_local_sensor.p : Vector3d::Zero();
  const int selected = selected_count_ + (curvature_ ? 1 : 0);
  for (int k = 0; k < selected; ++k) {
    const int index = selected_[k].measured->sensor;
    const Sensor& sensor = catheter_.sensors[index];
    const Pose& T = selected_[k].measured->T_base_sensor;
    const SensorErrors errors = errors_of(selected_[k]);
    const bool of_base = !sensor.T_tracker_base;
    for (int j = 0; j < parameters_.pose_count(); ++j) {
      const UncertainParameter& p = parameters_.all[parameters_.rod_count + j];
      if (p.sensor < 0 ? !of_base : p.sensor != index) continue;
      const Vector3d axis = Vector3d::Unit(p.axis);
      Vector3d moved = Vector3d::Zero(), turned = Vector3d::Zero();  // base axes
      if (p.kind == ParameterKind::kBasePosition || p.kind == ParameterKind::kSensorPosition) moved = axis;
      if (p.kind == ParameterKind::kBaseRotation) moved = axis.cross(T.p - pivot);
      if (p.kind == ParameterKind::kMountPosition) moved = local_axes(sensor, T) * axis;
      if (p.kind == ParameterKind::kBaseRotation || p.kind == ParameterKind::kSensorRotation) turned = axis;
      B.col(j) += errors.by_position * moved + errors.by_rotation * (T.R.transpose() * turned);
    }
  }
}

}  // namespace palpate
