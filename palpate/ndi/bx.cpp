// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/ndi/bx.hpp>
#include <palpate/ndi/bytes.hpp>
#include <palpate/ndi/command.hpp>
#include <palpate/ndi/faults.hpp>

namespace palpate::ndi {

namespace {

constexpr double kMetresPerMillimetre = 1e-3;
constexpr std::size_t kLength = 2, kHeadChecksum = 4;  // where they begin
constexpr std::uint32_t kUnusable =
    port_bits::kOutOfVolume | port_bits::kBrokenSensor | port_bits::kProcessingException;

std::uint16_t u16_at(std::span<const std::byte> bytes, std::size_t at) {
  return LittleEndianReader(bytes.subspan(at)).u16();
}

void check_sum(std::string_view what, std::uint16_t told, std::uint16_t is) {
  if (told != is) throw MalformedReply(fmt::format("BX: checksum {:04X} of the {}: expected {:04X}", told, what, is));
}

HandleReading take_handle(LittleEndianReader& body) {
  using Status = HandleReading::Status;
  HandleReading out;
  out.handle = body.u8();
  const std::uint8_t status = body.u8();
  out.status = static_cast<Status>(status);
  if (out.status == Status::kDisabled) return out;
  if (out.status == Status::kValid) {
    for (Eigen::Index i = 0; i < 4; ++i) out.quaternion_wxyz(i) = body.f32();
    for (Eigen::Index i = 0; i < 3; ++i) out.position_mm(i) = body.f32();
    out.error_mm = body.f32();
  } else if (out.status != Status::kMissing && body.ok()) {
    throw MalformedReply(fmt::format("BX: status {:02X} of handle {:02X}: expected 01, 02 or 04", status, out.handle));
  }
  out.port_status = body.u32();
  out.frame_number = body.u32();
  return out;
}

}  // namespace

std::size_t bx_size(std::span<const std::byte> head) {
  if (const std::uint16_t start = u16_at(head, 0); start != kBxStart)
    throw MalformedReply(fmt::format("BX: start {:04X}: expected {:04X}", start, kBxStart));
  check_sum("head", u16_at(head, kHeadChecksum), crc16(head.first(kHeadChecksum)));
  const std::size_t body = u16_at(head, kLength);
  if (body > kMostBody) throw MalformedReply(fmt::format("BX: length {}: expected at most {}", body, kMostBody));
  return kBxHead + body + kBxTail;
}

BxReply decode_bx(std::span<const std::byte> reply) {
  if (reply.size() < kBxHead || reply.size() != bx_size(reply))
    throw MalformedReply(fmt::format("BX: {} bytes: expected as many as the head says", reply.size()));
  const auto bytes = reply.subspan(kBxHead, reply.size() - kBxHead - kBxTail);
  check_sum("body", u16_at(reply, reply.size() - kBxTail), crc16(bytes));
  LittleEndianReader body(bytes);
  BxReply out;
  const std::size_t count = body.u8();
  out.handles.reserve(count);
  for (std::size_t i = 0; i < count && body.ok(); ++i) out.handles.push_back(take_handle(body));
  out.system_status = body.u16();
  if (!body.ok() || body.left() != 0)
    throw MalformedReply(fmt::format("BX: length {}: expected that of {} handles", bytes.size(), count));
  return out;
}

SensorReading sensor_reading(const HandleReading& reading) {
  SensorReading out;
  if (reading.status != HandleReading::Status::kValid || (reading.port_status & kUnusable) != 0) return out;
  out.status = SensorReading::Status::kOk;
  out.has_orientation = true;
  out.quaternion_wxyz = reading.quaternion_wxyz.cast<double>();
  out.position_m = kMetresPerMillimetre * reading.position_mm.cast<double>();
  out.error_m = kMetresPerMillimetre * static_cast<double>(reading.error_mm);
  return out;
}

}  // namespace palpate::ndi
