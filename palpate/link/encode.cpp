// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <palpate/link/byte_writer.hpp>
#include <palpate/link/codec.hpp>
#include <palpate/link/crc64.hpp>
#include <palpate/link/decode.hpp>
#include <palpate/link/text.hpp>
#include <palpate/math/errors.hpp>

namespace palpate::link {

namespace {

void check_most(std::string_view what, std::size_t found, std::size_t most) {
  if (found > most) throw InputError(fmt::format("OpenIGTLink: {} = {}: expected at most {}", what, found, most));
}

void put_field(ByteWriter& out, std::string_view what, std::string_view text, std::size_t width) {
  check_most(what, text.size(), width);
  out.field(text, width);
}

template <std::size_t N>
void put_floats(ByteWriter& out, const std::array<float, N>& values) {
  for (const float value : values) out.f32(value);
}

/// Writes a body's content and says which type it is.
struct Content {
  ByteWriter& out;

  std::string_view operator()(const Transform& body) const {
    put_floats(out, body.matrix.columns);
    return "TRANSFORM";
  }

  std::string_view operator()(const TrackingData& body) const {
    check_most("tools of TDATA", body.tools.size(), kMostTools);
    for (const TrackingData::Tool& tool : body.tools) {
      put_field(out, "bytes of a tool's name", tool.name, kDeviceBytes);
      out.u8(tool.type);
      out.u8(0);
      put_floats(out, tool.matrix.columns);
    }
    return "TDATA";
  }

  std::string_view operator()(const Position& body) const {
    put_floats(out, body.position_mm);
    if (body.quaternion_xyzw) put_floats(out, *body.quaternion_xyzw);
    return "POSITION";
  }

  std::string_view operator()(const QuaternionTrackingData& body) const {
    check_most("tools of QTDATA", body.tools.size(), kMostTools);
    for (const QuaternionTrackingData::Tool& tool : body.tools) {
      put_field(out, "bytes of a tool's name", tool.name, kDeviceBytes);
      out.u8(tool.type);
      out.u8(0);
      put_floats(out, tool.position_mm);
      put_floats(out, tool.quaternion_xyzw);
    }
    return "QTDATA";
  }

  std::string_view operator()(const Status& body) const {
    check_most("bytes of a status text", body.text.size(), kMostTextBytes);
    out.u16(body.code);
    out.u64(static_cast<std::uint64_t>(body.sub_code));
    put_field(out, "bytes of a status name", body.name, kDeviceBytes);
    out.raw(body.text);
    out.u8(0);  // older receivers read up to a zero
    return "STATUS";
  }

  std::string_view operator()(const String& body) const {
    check_most("bytes of a STRING", body.text.size(), kMostTextBytes);
    out.u16(encoding_of(body.text));
    out.u16(static_cast<std::uint16_t>(body.text.size()));
    out.raw(body.text);
    return "STRING";
  }

  std::string_view operator()(const Sensor& body) const {
    check_most("values of a SENSOR", body.values.size(), 255);
    out.u8(static_cast<std::uint8_t>(body.values.size()));
    out.u8(body.status);
    out.u64(body.unit);
    for (const double value : body.values) out.f64(value);
    return "SENSOR";
  }

  std::string_view operator()(const PolyData& body) const {
    check_most("bytes of a POLYDATA", 40 + 12 * body.points_mm.size(), kMostBodyBytes);
    check_most("lines of a POLYDATA", body.lines.size(), kMostLines);
    std::size_t line_bytes = 0;
    for (const auto& line : body.lines) line_bytes += 4 * (1 + line.size());
    out.u32(static_cast<std::uint32_t>(body.points_mm.size()));
    out.u64(0);  // no vertices
    out.u32(static_cast<std::uint32_t>(body.lines.size()));
    out.u32(static_cast<std::uint32_t>(line_bytes));
    for (int i = 0; i < 5; ++i) out.u32(0);  // no polygons, strips, attributes
    for (const auto& point : body.points_mm) {
      if (!std::ranges::all_of(point, [](float value) { return std::isfinite(value); }))
        throw InputError("OpenIGTLink: a point of a POLYDATA is not finite");
      put_floats(out, point);
    }
    for (const auto& line : body.lines) put_line(line, body.points_mm.size());
    return "POLYDATA";
  }

  void put_line(const std::vector<std::uint32_t>& line, std::size_t points) const {
    out.u32(static_cast<std::uint32_t>(line.size()));
    for (const std::uint32_t index : line) {
      if (index >= points)
        throw InputError(fmt::format("OpenIGTLink: point {} of a POLYDATA's line: expected one of {}", index, points));
      out.u32(index);
    }
  }

  std::string_view operator()(const StartTracking& body) const {
    out.u32(static_cast<std::uint32_t>(body.resolution_ms));
    put_field(out, "bytes of a coordinate system's name", body.coordinate_name, 32);
    return "STT_TDATA";
  }

  std::string_view operator()(const StopTracking&) const { return "STP_TDATA"; }
  std::string_view operator()(const GetCapability&) const { return "GET_CAPABIL"; }

  std::string_view operator()(const Capability& body) const {
    check_most("types of a CAPABILITY", body.types.size(), kMostCapabilities);
    for (const std::string& type : body.types) put_field(out, "bytes of a type's name", type, kTypeBytes);
    return "CAPABILITY";
  }

  std::string_view operator()(const Skipped& body) const {
    throw InputError(fmt::format("OpenIGTLink: type '{}': its body was not kept", body.type));
  }
};

void check_metadata(const Message& message) {
  if (message.version == 1) check_most("pairs of metadata in version 1", message.metadata.size(), 0);
  check_most("pairs of metadata", message.metadata.size(), kMostMetadata);
  std::size_t bytes = 0;
  for (const auto& [key, value] : message.metadata) {
    check_most("bytes of a metadata key", key.size(), kMostTextBytes);
    bytes += key.size() + value.size();
  }
  check_most("bytes of metadata", bytes, kMostMetadataBytes);
}

void check_header(const Message& message) {
  if (message.version != 1 && message.version != 2)
    throw InputError(fmt::format("OpenIGTLink: header version = {}: expected 1 or 2", message.version));
  check_most("bytes of a device name", message.device.size(), kDeviceBytes);
  if (!stamp_of(message.time_s))
    throw InputError(fmt::format("OpenIGTLink: time = {} s: expected [0, 2^32)", message.time_s));
  check_metadata(message);
}

}  // namespace

void encode(const Message& message, std::vector<std::byte>& out) {
  check_header(message);
  std::vector<std::byte> body;
  ByteWriter writer(body);
  if (message.version == 2) write_extended_header(message.metadata, writer);
  const std::string_view type = std::visit(Content{writer}, message.body);
  if (message.version == 2) write_metadata(message.metadata, writer);
  check_most("bytes of a body", body.size(), kMostBodyBytes);
  ByteWriter header(out);
  write_header({message.version, std::string(type), message.device, message.time_s, body.size(), crc64(body)}, header);
  out.insert(out.end(), body.begin(), body.end());
}

}  // namespace palpate::link
