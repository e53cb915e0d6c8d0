// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <palpate/link/byte_reader.hpp>
#include <palpate/link/codec.hpp>
#include <palpate/link/decode.hpp>
#include <palpate/link/header.hpp>
#include <palpate/link/text.hpp>

namespace palpate::link {

namespace {

using Bytes = std::span<const std::byte>;

constexpr std::size_t kToolBytes = 70, kQuaternionToolBytes = 50, kStatusBytes = 30, kSensorBytes = 10;

template <std::size_t N>
std::array<float, N> floats(ByteReader& in) {
  std::array<float, N> values;
  for (float& value : values) value = in.f32();
  return values;
}

std::string not_whole(std::size_t bytes, std::size_t element) {
  return fmt::format("{} bytes: expected a multiple of {}", bytes, element);
}

// Poses are passed on as they are, finite or not: the observer screens them and counts what it refuses.

std::string decode_transform(Bytes content, Body& body) {
  ByteReader in(content);
  body = Transform{{floats<12>(in)}};
  return {};
}

std::string decode_tracking(Bytes content, Body& body) {
  if (content.size() % kToolBytes != 0) return not_whole(content.size(), kToolBytes);
  ByteReader in(content);
  TrackingData data;
  while (in.left() > 0) {
    TrackingData::Tool& tool = data.tools.emplace_back();
    tool.name = in.field(kDeviceBytes);
    tool.type = in.u8();
    in.u8();  // reserved
    tool.matrix.columns = floats<12>(in);
  }
  body = std::move(data);
  return {};
}

std::string decode_quaternion_tracking(Bytes content, Body& body) {
  if (content.size() % kQuaternionToolBytes != 0) return not_whole(content.size(), kQuaternionToolBytes);
  ByteReader in(content);
  QuaternionTrackingData data;
  while (in.left() > 0) {
    QuaternionTrackingData::Tool& tool = data.tools.emplace_back();
    tool.name = in.field(kDeviceBytes);
    tool.type = in.u8();
    in.u8();  // reserved
    tool.position_mm = floats<3>(in);
    tool.quaternion_xyzw = floats<4>(in);
  }
  body = std::move(data);
  return {};
}

/// Three lengths: the point alone, with the quaternion's vector part (its scalar then is the positive root), with all.
std::string decode_position(Bytes content, Body& body) {
  ByteReader in(content);
  Position position{.position_mm = floats<3>(in), .quaternion_xyzw = {}};
  if (content.size() == 28) {
    position.quaternion_xyzw = floats<4>(in);
  } else if (content.size() == 24) {
    const auto [x, y, z] = floats<3>(in);
    position.quaternion_xyzw = {x, y, z, std::sqrt(1 - x * x - y * y - z * z)};
  } else if (content.size() != 12) {
    return fmt::format("{} bytes: expected 12, 24 or 28", content.size());
  }
  body = position;
  return {};
}

std::string decode_status(Bytes content, Body& body) {
  ByteReader in(content);
  Status status;
  status.code = in.u16();
  status.sub_code = static_cast<std::int64_t>(in.u64());
  status.name = in.field(kDeviceBytes);
  status.text = in.field(in.left());
  body = std::move(status);
  return {};
}

std::string decode_string(Bytes content, Body& body) {
  ByteReader in(content);
  const std::uint16_t encoding = in.u16();
  const std::size_t length = in.u16();
  if (length != in.left()) return fmt::format("LENGTH = {}: expected {}", length, in.left());
  if (encoding == kAscii || encoding == kUtf8)
    body = String{in.raw(length)};
  else
    body = Skipped{"STRING"};
  return {};
}

/// NaN is a value that is not there; an infinite one is no measurement.
std::string decode_sensor(Bytes content, Body& body) {
  ByteReader in(content);
  const std::size_t length = in.u8();
  if (content.size() != kSensorBytes + 8 * length)
    return fmt::format("LARRAY = {}: expected {} bytes, not {}", length, kSensorBytes + 8 * length, content.size());
  Sensor sensor;
  sensor.status = in.u8();
  sensor.unit = in.u64();
  while (in.left() > 0) sensor.values.push_back(in.f64());
  if (std::ranges::any_of(sensor.values, [](double value) { return std::isinf(value); }))
    return "a value is infinite: expected numbers, or NaN for none";
  body = std::move(sensor);
  return {};
}

std::string decode_start_tracking(Bytes content, Body& body) {
  ByteReader in(content);
  StartTracking start;
  start.resolution_ms = static_cast<std::int32_t>(in.u32());
  start.coordinate_name = in.field(32);
  body = std::move(start);
  return {};
}

std::string decode_capability(Bytes content, Body& body) {
  if (content.size() % kTypeBytes != 0) return not_whole(content.size(), kTypeBytes);
  ByteReader in(content);
  Capability capability;
  while (in.left() > 0) capability.types.push_back(in.field(kTypeBytes));
  body = std::move(capability);
  return {};
}

template <typename Empty>
std::string decode_empty(Bytes, Body& body) {
  body = Empty{};
  return {};
}

constexpr std::array<Type, 12> kTypes{{
    {"TRANSFORM", 48, 48, decode_transform},
    {"TDATA", 0, kMostTools* kToolBytes, decode_tracking},
    {"POSITION", 12, 28, decode_position},
    {"QTDATA", 0, kMostTools* kQuaternionToolBytes, decode_quaternion_tracking},
    {"STATUS", kStatusBytes, kStatusBytes + kMostTextBytes + 1, decode_status},
    {"STRING", 4, 4 + kMostTextBytes, decode_string},
    {"SENSOR", kSensorBytes, kSensorBytes + 8 * 255, decode_sensor},
    {"POLYDATA", 40, kMostBodyBytes, decode_polydata},
    {"STT_TDATA", 36, 36, decode_start_tracking},
    {"STP_TDATA", 0, 0, decode_empty<StopTracking>},
    {"GET_CAPABIL", 0, 0, decode_empty<GetCapability>},
    {"CAPABILITY", 0, kMostCapabilities* kTypeBytes, decode_capability},
}};

}  // namespace

const Type* find_type(std::string_view name) {
  const auto found = std::ranges::find(kTypes, name, &Type::name);
  return found == kTypes.end() ? nullptr : &*found;
}

std::vector<std::string> type_names() {
  std::vector<std::string> names;
  names.reserve(kTypes.size());
  for (const Type& type : kTypes) names.emplace_back(type.name);
  return names;
}

}  // namespace palpate::link
