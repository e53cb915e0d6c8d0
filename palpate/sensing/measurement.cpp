// SPDX-License-Identifier: Apache-2.0
#include <cassert>
#include <palpate/sensing/measurement.hpp>

namespace palpate {

Pose reading_pose(const SensorReading& reading) {
  Pose T;
  T.p = reading.position_m;
  if (reading.has_orientation) {
    const Eigen::Vector4d& q = reading.quaternion_wxyz;
    T.R = Eigen::Quaterniond(q(0), q(1), q(2), q(3)).normalized().toRotationMatrix();
  }
  return T;
}

void register_frame(const Catheter& catheter, const TrackerFrame& frame, Measurement& measurement) {
  const std::size_t sensors = catheter.sensors.size();
  assert(frame.readings.size() == sensors + (catheter.base.tracked ? 1 : 0));
  measurement.count = 0;
  measurement.rejections.fill(Rejection::kNone);
  for (std::size_t i = 0; i < sensors; ++i)
    measurement.rejections[i] = screen(frame.readings[i], catheter.sensors[i].kind);

  Pose T_tracker_base = catheter.base.T_tracker_base;
  bool base_known = true;
  if (catheter.base.tracked) {
    const SensorReading& base = frame.readings[sensors];
    measurement.rejections[sensors] = screen(base, SensorKind::kPose);
    base_known = measurement.rejections[sensors] == Rejection::kNone;
    if (base_known) T_tracker_base = reading_pose(base) * catheter.base.sensor.T_local_sensor.inverse();
  }
  const Pose T_base_tracker = T_tracker_base.inverse();
  for (std::size_t i = 0; i < sensors; ++i) {
    const Sensor& sensor = catheter.sensors[i];
    const bool own_base = sensor.T_tracker_base.has_value();
    if (measurement.rejections[i] != Rejection::kNone || !(own_base || base_known)) continue;
    measurement.poses[static_cast<std::size_t>(measurement.count++)] = {
        static_cast<int>(i),
        (own_base ? sensor.T_tracker_base->inverse() : T_base_tracker) * reading_pose(frame.readings[i])};
  }
}

}  // namespace palpate
