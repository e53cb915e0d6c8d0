// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// Structs with the fields and field types of the ROS 2 messages of the same names.
namespace palpate::test::ros {

struct Time {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};
struct Header {
  Time stamp;
  std::string frame_id;
};
struct Vector3 {
  double x = 0.0, y = 0.0, z = 0.0;
};
struct Quaternion {
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;
};
struct Pose {
  Vector3 position;
  Quaternion orientation;
};
struct PoseStamped {
  Header header;
  Pose pose;
};
struct Wrench {
  Vector3 force, torque;
};
struct ForceWithCovarianceStamped {
  Header header;
  Vector3 force;
  std::array<double, 9> covariance{};
};
struct KeyValue {
  std::string key, value;
};
struct DiagnosticStatus {
  unsigned char level = 0;
  std::string name, message, hardware_id;
  std::vector<KeyValue> values;
};

}  // namespace palpate::test::ros
