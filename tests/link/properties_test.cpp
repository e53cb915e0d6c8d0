// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <bit>
#include <cmath>
#include <tests/link/example_messages.hpp>
#include <tests/seeded_check.hpp>

/// Whatever the message, the split of the stream or the damage done to it.
namespace palpate::link::test {
namespace {

std::string text(int most) {
  const auto length = static_cast<std::size_t>(*rc::gen::inRange(0, most + 1));
  return *rc::gen::container<std::string>(length, rc::gen::nonZero<char>());
}

template <std::size_t N>
std::array<float, N> any_floats() {
  std::array<float, N> values;
  for (float& value : values) value = std::bit_cast<float>(*rc::gen::arbitrary<std::uint32_t>());
  return values;
}

std::uint8_t any_byte() { return *rc::gen::arbitrary<std::uint8_t>(); }

TrackingData any_tracking() {
  TrackingData data;
  data.tools.resize(*rc::gen::inRange<std::size_t>(0, 5));
  for (auto& tool : data.tools) tool = {text(20), any_byte(), {any_floats<12>()}};
  return data;
}

QuaternionTrackingData any_quaternion_tracking() {
  QuaternionTrackingData data;
  data.tools.resize(*rc::gen::inRange<std::size_t>(0, 5));
  for (auto& tool : data.tools) tool = {text(20), any_byte(), any_floats<3>(), any_floats<4>()};
  return data;
}

Sensor any_sensor() {
  Sensor sensor{any_byte(), *rc::gen::arbitrary<std::uint64_t>(), {}};
  sensor.values.resize(*rc::gen::inRange<std::size_t>(0, 256));
  for (double& value : sensor.values) {
    value = std::bit_cast<double>(*rc::gen::arbitrary<std::uint64_t>());
    if (std::isinf(value)) value = 0;
  }
  return sensor;
}

PolyData any_mesh() {
  PolyData mesh;
  mesh.points_mm.resize(*rc::gen::inRange<std::size_t>(1, 20));
  for (auto& point : mesh.points_mm)
    for (float& value : point) value = static_cast<float>(*rc::gen::inRange(-100000, 100000)) / 7;
  mesh.lines.resize(*rc::gen::inRange<std::size_t>(0, 5));
  for (auto& line : mesh.lines) {
    line.resize(*rc::gen::inRange<std::size_t>(0, 20));
    for (auto& index : line) index = *rc::gen::inRange(0U, static_cast<std::uint32_t>(mesh.points_mm.size()));
  }
  return mesh;
}

Capability any_capability() {
  Capability capability;
  capability.types.resize(*rc::gen::inRange<std::size_t>(0, 20));
  for (auto& type : capability.types) type = text(12);
  return capability;
}

Body any_body() {
  switch (*rc::gen::inRange(0, 13)) {
    case 0:
      return Transform{{any_floats<12>()}};
    case 1:
      return any_tracking();
    case 2:
      return Position{any_floats<3>(), {}};
    case 3:
      return Position{any_floats<3>(), any_floats<4>()};
    case 4:
      return any_quaternion_tracking();
    case 5:
      return Status{*rc::gen::arbitrary<std::uint16_t>(), *rc::gen::arbitrary<std::int64_t>(), text(20), text(500)};
    case 6:
      return String{text(500)};
    case 7:
      return any_sensor();
    case 8:
      return any_mesh();
    case 9:
      return StartTracking{*rc::gen::arbitrary<std::int32_t>(), text(32)};
    case 10:
      return StopTracking{};
    case 11:
      return GetCapability{};
    default:
      return any_capability();
  }
}

Message any_message() {
  Message message;
  message.version = *rc::gen::element<std::uint16_t>(1, 2);
  message.device = text(20);
  message.time_s = seconds_of(*rc::gen::arbitrary<std::uint64_t>());
  message.body = any_body();
  if (message.version == 2) {
    message.metadata.resize(*rc::gen::inRange<std::size_t>(0, 6));
    for (auto& [key, value] : message.metadata) key = text(30), value = text(300);
  }
  return message;
}

TEST(LinkProperties, DecodingUndoesEncoding) {
  palpate::test::seeded_check("decode(encode(m)) = m", [] {
    const Message message = any_message();
    const Bytes bytes = encoded(message);
    const Decoded back = decoded(bytes);
    RC_ASSERT(back.fault.empty());
    RC_ASSERT(back.messages.size() == 1U);
    RC_ASSERT(encoded(back.messages[0]) == bytes);  // NaN is not equal to itself, its bytes are
    RC_ASSERT(back.messages[0].body.index() == message.body.index());
    RC_ASSERT(back.messages[0].metadata == message.metadata);
    RC_ASSERT(back.messages[0].time_s == message.time_s);
  });
}

TEST(LinkProperties, AnySplitGivesTheSame) {
  palpate::test::seeded_check("pieces of any size", [] {
    Bytes stream;
    const int count = *rc::gen::inRange(1, 5);
    for (int i = 0; i < count; ++i) encode(any_message(), stream);
    const auto pieces = *rc::gen::container<std::vector<std::size_t>>(rc::gen::inRange<std::size_t>(0, 300));
    Decoder decoder;
    Message message;
    Bytes again;
    std::span<const std::byte> rest(stream);
    for (std::size_t i = 0; !rest.empty(); ++i) {
      std::span<const std::byte> piece = rest.first(std::min(i < pieces.size() ? pieces[i] : 1000, rest.size()));
      rest = rest.subspan(piece.size());
      while (decoder.take(piece, message) == Decoder::Result::kMessage) encode(message, again);
      RC_ASSERT(decoder.fault().empty());
    }
    RC_ASSERT(again == stream);
  });
}

/// Damages some bytes; half of the time the CRC is made right again, so that bodies are reached.
TEST(LinkProperties, DamageIsSurvived) {
  palpate::test::seeded_check("any damage", [] {
    Bytes bytes = encoded(any_message());
    const int faults = *rc::gen::inRange(1, 6);
    for (int i = 0; i < faults; ++i)
      bytes[*rc::gen::inRange<std::size_t>(0, bytes.size())] = static_cast<std::byte>(any_byte());
    if (*rc::gen::arbitrary<bool>()) {
      Bytes crc;
      ByteWriter(crc).u64(crc64(std::span(bytes).subspan(kHeaderBytes)));
      std::copy(crc.begin(), crc.end(), bytes.begin() + 50);
    }
    bytes.resize(*rc::gen::inRange<std::size_t>(0, bytes.size() + 100));
    const Decoded whole = decoded(bytes), apart = decoded(bytes, 7);
    RC_ASSERT(whole.fault == apart.fault);
    RC_ASSERT(whole.messages.size() == apart.messages.size());
    for (const Message& message : whole.messages)
      if (!std::holds_alternative<Skipped>(message.body)) {
        const Bytes again = encoded(message);
        RC_ASSERT(encoded(decoded(again).messages.at(0)) == again);
      }
  });
}

}  // namespace
}  // namespace palpate::link::test
