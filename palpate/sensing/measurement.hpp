// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <palpate/math/linearization.hpp>
#include <palpate/sensing/screening.hpp>

namespace palpate {

/// One tracker frame, screened and brought into the base frame: what is left to learn the shape from.
struct Measurement {
  struct SensorPose {
    int sensor = 0;      ///< index into Catheter::sensors
    Pose T_base_sensor;  ///< orientation unused for a position sensor
  };
  int count = 0;
  std::array<SensorPose, kMaxSensors> poses;
  std::array<Rejection, kMaxSensors + 1> rejections{};  ///< of each reading; the base sensor's last
};

/// Screens every reading and registers the good ones: T_base_sensor = T_tracker_base^-1 T_tracker_sensor, with the
/// clamp as the sensor's own registration has it (Sensor::T_tracker_base), else from the catheter file or, where it is
/// tracked, from its own sensor in the same frame. A base that is lost or not in the frame leaves out the sensors that
/// need it: the base may have moved since it was seen last, and nothing says by how much.
/// No allocation. Precondition: frame.readings has one entry a sensor (and one for a tracked base).
void register_frame(const Catheter& catheter, const TrackerFrame& frame, Measurement& measurement);

/// Pose of a reading that passed the screening, in the tracker's frame.
Pose reading_pose(const SensorReading& reading);

}  // namespace palpate
