// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <palpate/math/units.hpp>
#include <palpate/sensing/rounded_rotation.hpp>
#include <palpate/service/pose_message.hpp>

namespace palpate::service {

namespace {

SensorReading reading_at(const std::array<float, 3>& position_mm) {
  SensorReading reading;
  reading.status = SensorReading::Status::kOk;
  for (int i = 0; i < 3; ++i)
    reading.position_m(i) = kMetresPerMillimetre * static_cast<double>(position_mm[static_cast<std::size_t>(i)]);
  return reading;
}

SensorReading reading_of(const std::array<float, 3>& position_mm, const std::array<float, 4>& quaternion_xyzw) {
  SensorReading reading = reading_at(position_mm);
  reading.has_orientation = true;
  const auto& q = quaternion_xyzw;
  reading.quaternion_wxyz = Eigen::Vector4f(q[3], q[0], q[1], q[2]).cast<double>();
  return reading;
}

/// PLUS says so in the metadata of version 2 alone.
bool is_valid(const link::Message& message) {
  return std::none_of(message.metadata.begin(), message.metadata.end(), [](const auto& entry) {
    const auto& [key, value] = entry;
    return (key == "TransformValid" && (value == "false" || value == "FALSE" || value == "0")) ||
           (key.ends_with("TransformStatus") && value != "OK");
  });
}

}  // namespace

SensorReading reading_of(const link::Matrix& matrix) {
  const auto& m = matrix.columns;
  SensorReading reading = reading_at({m[9], m[10], m[11]});
  reading.has_orientation = true;
  Matrix3d R;
  for (int i = 0; i < 9; ++i) R(i % 3, i / 3) = static_cast<double>(m[static_cast<std::size_t>(i)]);
  reading.quaternion_wxyz = nearest_quaternion(R);
  return reading;
}

void for_each_pose(const link::Message& message,
                   const std::function<void(std::string_view device, const SensorReading& reading)>& visit) {
  const auto say = [&](const std::string& device, SensorReading reading) {
    if (!is_valid(message)) reading.status = SensorReading::Status::kMissing;
    visit(device, reading);
  };
  if (const auto* const transform = std::get_if<link::Transform>(&message.body)) {
    say(message.device, reading_of(transform->matrix));
  } else if (const auto* const tracking = std::get_if<link::TrackingData>(&message.body)) {
    for (const auto& tool : tracking->tools) say(tool.name, reading_of(tool.matrix));
  } else if (const auto* const position = std::get_if<link::Position>(&message.body)) {
    say(message.device, position->quaternion_xyzw ? reading_of(position->position_mm, *position->quaternion_xyzw)
                                                  : reading_at(position->position_mm));
  } else if (const auto* const quaternions = std::get_if<link::QuaternionTrackingData>(&message.body)) {
    for (const auto& tool : quaternions->tools) say(tool.name, reading_of(tool.position_mm, tool.quaternion_xyzw));
  }
}

}  // namespace palpate::service
