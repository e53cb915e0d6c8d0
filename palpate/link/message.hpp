// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

/// OpenIGTLink messages as plain data (openigtlink.org, protocol versions 1 to 3). Lengths are those of the wire:
/// millimetres. Strings are the bytes of the wire: whoever writes them as UTF-8 has to look at them first.
namespace palpate::link {

/// Rotation and translation as the wire has them: three columns and the origin, single precision.
struct Matrix {
  std::array<float, 12> columns{1, 0, 0, 0, 1, 0,
                                0, 0, 1, 0, 0, 0};  ///< r11 r21 r31  r12 r22 r32  r13 r23 r33  tx ty tz
  bool operator==(const Matrix&) const = default;
};

struct Transform {
  Matrix matrix;
  bool operator==(const Transform&) const = default;
};

/// TDATA: several tools of a tracker at one time.
struct TrackingData {
  struct Tool {
    std::string name;
    std::uint8_t type = 0;  ///< 1 tracker, 2: 6D instrument, 3: 3D, 4: 5D
    Matrix matrix;
    bool operator==(const Tool&) const = default;
  };
  std::vector<Tool> tools;
  bool operator==(const TrackingData&) const = default;
};

/// POSITION: a point, with or without its quaternion (x, y, z, w).
struct Position {
  std::array<float, 3> position_mm{};
  std::optional<std::array<float, 4>> quaternion_xyzw;
  bool operator==(const Position&) const = default;
};

/// QTDATA: as TDATA, with quaternions.
struct QuaternionTrackingData {
  struct Tool {
    std::string name;
    std::uint8_t type = 0;
    std::array<float, 3> position_mm{};
    std::array<float, 4> quaternion_xyzw{0, 0, 0, 1};
    bool operator==(const Tool&) const = default;
  };
  std::vector<Tool> tools;
  bool operator==(const QuaternionTrackingData&) const = default;
};

struct Status {
  std::uint16_t code = 1;  ///< 1: OK
  std::int64_t sub_code = 0;
  std::string name, text;
  bool operator==(const Status&) const = default;
};

struct String {
  std::string text;  ///< UTF-8 (encoding 106) or US-ASCII (3)
  bool operator==(const String&) const = default;
};

struct Sensor {
  std::uint8_t status = 0;
  std::uint64_t unit = 0;  ///< igtl_unit; kNewton
  std::vector<double> values = {};
  bool operator==(const Sensor&) const = default;
};
inline constexpr std::uint64_t kNewton = 0x02C4000000000000;  ///< igtl_unit: derived unit 0x0B, exponent 1

struct PolyData {
  std::vector<std::array<float, 3>> points_mm;
  std::vector<std::vector<std::uint32_t>> lines;  ///< indices of points
  bool operator==(const PolyData&) const = default;
};

struct StartTracking {  ///< STT_TDATA
  std::int32_t resolution_ms = 0;
  std::string coordinate_name;
  bool operator==(const StartTracking&) const = default;
};
struct StopTracking {  ///< STP_TDATA
  bool operator==(const StopTracking&) const = default;
};
struct GetCapability {  ///< GET_CAPABIL
  bool operator==(const GetCapability&) const = default;
};
struct Capability {  ///< CAPABILITY
  std::vector<std::string> types;
  bool operator==(const Capability&) const = default;
};
/// Any other type: its body was passed over.
struct Skipped {
  std::string type;
  bool operator==(const Skipped&) const = default;
};

using Body = std::variant<Transform, TrackingData, Position, QuaternionTrackingData, Status, String, Sensor, PolyData,
                          StartTracking, StopTracking, GetCapability, Capability, Skipped>;

struct Message {
  std::uint16_t version = 1;  ///< of the header: 1, or 2 with extended header and metadata
  std::string device = {};    ///< at most 20 bytes on the wire
  double time_s = 0.0;        ///< since 1970, UTC; 0: none
  Body body = {};
  std::vector<std::pair<std::string, std::string>> metadata = {};  ///< version 2 alone
  bool operator==(const Message&) const = default;
};

}  // namespace palpate::link
