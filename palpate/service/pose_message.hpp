// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <palpate/link/message.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <string_view>

namespace palpate::service {

/// Sensor to tracker [m], as the matrix has it; a matrix more than 1 % away from a rotation gets a zero quaternion, and
/// screening refuses it. Rounded rotations become the nearest one.
SensorReading reading_of(const link::Matrix& matrix);

/// Every pose that a message carries: device and reading. What PLUS marks as not valid is missing.
void for_each_pose(const link::Message& message,
                   const std::function<void(std::string_view device, const SensorReading& reading)>& visit);

}  // namespace palpate::service
