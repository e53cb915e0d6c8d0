// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/math/linearization.hpp>
#include <palpate/rod/statics.hpp>
#include <palpate/sensing/catheter.hpp>

/// How one sensor on the shaft sees the rod. Orientation residuals live on SO(3), log(R_predicted^T R_measured): Euler
/// angles are singular inside the catheter's working range.
namespace palpate {

/// Scalar quantities a sensor of this kind measures: 6, 5 or 3.
int rows_of(SensorKind kind);

/// Predicted sensor pose with the tangents of its rotation (body side, sensor axes) and position (base components).
template <int N>
struct PredictedSensor {
  Pose T_base_sensor;
  Eigen::Matrix<double, 3, N> rotation, position_m;
};

/// The rod's local frame at the sensor, moved by the mounting: p = p_local + R_local c, phi_sensor = R_mount^T
/// phi_local.
template <int N>
PredictedSensor<N> predict_sensor(const Sensor& sensor, const RodPoint& point, const RodPointTangent<N>& tangent) {
  const Pose& mount = sensor.T_local_sensor;
  const Matrix3d& R = point.T_base_local.R;
  return {point.T_base_local * mount, mount.R.transpose() * tangent.rotation,
          tangent.position_m - R * hat(mount.p) * tangent.rotation};
}

/// Orientation part of a residual and its derivative with respect to the predicted sensor's body rotation, negated:
/// r(phi) = r - D phi. Three rows for a pose; two for pose5 (the turn about sensor x and y that takes the predicted z
/// axis to the measured one).
struct OrientationResidual {
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> value;
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 3, 3> D;
};
OrientationResidual orientation_residual(SensorKind kind, const Matrix3d& R_predicted, const Matrix3d& R_measured);

/// Appends a sensor's rows at `row`: position p_measured - p_predicted [m], base components; then orientation [rad].
/// As many of the N derivatives as the Jacobian has columns.
template <int N>
void append_sensor_rows(SensorKind kind, const PredictedSensor<N>& predicted, const Pose& measured, int row,
                        Linearization& at) {
  const Eigen::Index columns = at.jacobian.cols();
  at.residual.segment<3>(row) = measured.p - predicted.T_base_sensor.p;
  at.jacobian.middleRows<3>(row) = predicted.position_m.leftCols(columns);
  if (kind == SensorKind::kPosition) return;
  const OrientationResidual r = orientation_residual(kind, predicted.T_base_sensor.R, measured.R);
  at.residual.segment(row + 3, r.value.size()) = r.value;
  at.jacobian.middleRows(row + 3, r.value.size()).noalias() = r.D.lazyProduct(predicted.rotation.leftCols(columns));
}

}  // namespace palpate
