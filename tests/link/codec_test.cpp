// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <palpate/math/errors.hpp>
#include <tests/link/example_messages.hpp>

/// The codec against itself and against bytes written down by hand from the protocol's pages (header.md, index.md,
/// timestamp.md and the types' pages of Documents/Protocol, protocol 3.0 of January 20, 2017).
namespace palpate::link::test {
namespace {

using ::testing::HasSubstr;

Bytes bytes_of(const std::string& text) {
  const auto view = std::as_bytes(std::span(text));
  return {view.begin(), view.end()};
}

/// 0xFF as "ff"; white space is skipped.
Bytes from_hex(const std::string& hex) {
  Bytes bytes;
  std::string digits;
  for (const char c : hex) {
    if (c == ' ') continue;
    digits += c;
    if (digits.size() < 2) continue;
    bytes.push_back(static_cast<std::byte>(std::stoi(digits, nullptr, 16)));
    digits.clear();
  }
  return bytes;
}

std::string refusal(const Message& message) {
  Bytes bytes{std::byte{1}};
  try {
    encode(message, bytes);
  } catch (const InputError& error) {
    EXPECT_EQ(bytes.size(), 1U);
    return error.what();
  }
  return "nothing was refused";
}

TEST(LinkCodec, CrcOfEcma182) {
  // The catalogue of CRCs (reveng.sourceforge.io, CRC-64/ECMA-182) gives this check value for "123456789".
  EXPECT_EQ(crc64(bytes_of("123456789")), 0x6C40DF5F0B497347U);
  EXPECT_EQ(crc64({}), 0U);
}

TEST(LinkCodec, EveryTypeComesBack) {
  for (Message message : example_messages()) {
    for (const std::uint16_t version : std::initializer_list<std::uint16_t>{1, 2}) {
      message.version = version;
      if (version == 2) message.metadata = {{"TransformStatus", "OK"}, {"Note", "gr\xC3\xBC\xC3\x9F"}, {"", ""}};
      const Decoded back = decoded(encoded(message));
      ASSERT_EQ(back.messages.size(), 1U) << message.body.index() << ": " << back.fault;
      EXPECT_EQ(back.messages[0], message) << message.body.index();
    }
  }
}

TEST(LinkCodec, VersionTwoByHand) {
  // header.md: V, TYPE 12, DEVICE_NAME 20, TIME_STAMP, BODY_SIZE, CRC. timestamp.md: 32.32 fixed point, so 2.25 s is
  // 2 and a quarter of 2^32. index.md: EXT_HEADER_SIZE 2, METADATA_HEADER_SIZE 2, METADATA_SIZE 4, MSG_ID 4 (12 bytes
  // in all), the content, INDEX_COUNT 2, then KEY_SIZE 2, VALUE_ENCODING 2 (3: US-ASCII), VALUE_SIZE 4 a pair, then
  // keys and values. header.md: BODY_SIZE counts all of that: 12 + 36 + 10 + 17 = 75 = 0x4b. trackingdata.md: STT_TDATA
  // has RESOL 4 and a coordinate system's name of 32 bytes.
  const Bytes body = from_hex(
      "000c 000a 00000011 00000000"
      "00000032 43414d455241 0000000000000000000000000000000000000000000000000000"
      "0001 000f 0003 00000002"
      "5472616e73666f726d537461747573 4f4b");
  Bytes expected = from_hex(
      "0002 5354545f5444415441000000 436c69656e740000000000000000000000000000 0000000240000000 000000000000004b");
  ByteWriter(expected).u64(crc64(body));
  expected.insert(expected.end(), body.begin(), body.end());
  const Message message{.version = 2,
                        .device = "Client",
                        .time_s = 2.25,
                        .body = StartTracking{50, "CAMERA"},
                        .metadata = {{"TransformStatus", "OK"}}};
  EXPECT_EQ(encoded(message), expected);
  ASSERT_EQ(decoded(expected).messages.size(), 1U);
  EXPECT_EQ(decoded(expected).messages[0], message);
}

TEST(LinkCodec, LaterExtendedHeadersAndAbsentCountsAreRead) {
  // Four more bytes in the extended header; no metadata header at all.
  const Bytes longer = from_hex("0010 0002 00000000 00000007 deadbeef 0000");
  const Bytes none = from_hex("000c 0000 00000000 00000007");
  for (const Bytes& body : {longer, none}) {
    const Decoded back = decoded(raw_message("GET_CAPABIL", body, 2));
    ASSERT_EQ(back.messages.size(), 1U) << back.fault;
    EXPECT_EQ(back.messages[0].body, Body(GetCapability{}));
  }
}

TEST(LinkCodec, AnySplitGivesTheSameMessages) {
  Bytes stream;
  std::vector<Message> sent = example_messages();
  for (const Message& message : sent) encode(message, stream);
  const Bytes unknown = raw_message("IMAGE", Bytes(1000));
  stream.insert(stream.end(), unknown.begin(), unknown.end());
  encode(sent[0], stream);
  sent.push_back({.version = 1, .device = "Hand", .time_s = 0.0, .body = Skipped{"IMAGE"}, .metadata = {}});
  sent.push_back(sent[0]);
  for (const std::size_t chunk : std::initializer_list<std::size_t>{1, 2, 3, 57, 58, 59, 117, 4096, 1 << 20}) {
    const Decoded back = decoded(stream, chunk);
    EXPECT_EQ(back.messages, sent) << chunk;
    EXPECT_EQ(back.fault, "");
  }
}

TEST(LinkCodec, PosesPassAsTheyAreWhateverTheyHold) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const Matrix bad{{nan, inf, -inf, 9, 9, 9, 0, 0, 0, -0.0f, 1e-45f, nan}};
  const std::vector<Body> bodies{Transform{bad}, TrackingData{{{"Tip", 9, bad}}},
                                 Position{{nan, inf, 0}, {{0, 0, 0, 0}}},
                                 QuaternionTrackingData{{{"Tip", 0, {inf, 0, nan}, {nan, 0, 0, 2}}}}};
  for (const Body& body : bodies) {
    const Bytes bytes = encoded({.version = 1, .device = "Tip", .time_s = 1.0, .body = body, .metadata = {}});
    const Decoded back = decoded(bytes);
    ASSERT_EQ(back.messages.size(), 1U) << body.index() << ": " << back.fault;
    EXPECT_EQ(encoded(back.messages[0]), bytes) << body.index();  // bit for bit: NaN is not equal to itself
  }
}

TEST(LinkCodec, AForceThatIsNotLivePasses) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Bytes bytes = encoded({.device = "Force", .body = Sensor{0, kNewton, {nan, nan, nan}}, .metadata = {}});
  const Decoded back = decoded(bytes);
  ASSERT_EQ(back.messages.size(), 1U);
  EXPECT_TRUE(std::isnan(std::get<Sensor>(back.messages[0].body).values[2]));
}

TEST(LinkCodec, ThreeLengthsOfPosition) {
  // position.md has 28 bytes; senders may leave out the quaternion's last number (24) or all four (12).
  Bytes body;
  ByteWriter out(body);
  for (const float value : {1.0f, 2.0f, 3.0f, 0.0f, 0.6f, 0.0f}) out.f32(value);
  const Decoded back = decoded(raw_message("POSITION", body));
  ASSERT_EQ(back.messages.size(), 1U);
  const auto& position = std::get<Position>(back.messages[0].body);
  ASSERT_TRUE(position.quaternion_xyzw);
  EXPECT_FLOAT_EQ((*position.quaternion_xyzw)[3], 0.8f);
  body.resize(12);
  const Decoded point = decoded(raw_message("POSITION", body));
  ASSERT_EQ(point.messages.size(), 1U);
  EXPECT_EQ(point.messages[0].body, Body(Position{{1, 2, 3}, {}}));
}

TEST(LinkCodec, TimeIsFixedPoint) {
  EXPECT_EQ(seconds_of(0), 0.0);
  EXPECT_EQ(seconds_of(0x0000000180000000), 1.5);
  EXPECT_EQ(stamp_of(1.5), 0x0000000180000000U);
  EXPECT_EQ(seconds_of(*stamp_of(1700000000.123456)), 1700000000.123456);
  for (const std::uint64_t stamp : {0ULL, 1ULL, 0x80000000ULL, 0x6553F1001F9ACF00ULL, ~0ULL, ~0ULL << 10}) {
    const double time_s = seconds_of(stamp);
    ASSERT_TRUE(stamp_of(time_s)) << stamp;
    EXPECT_EQ(seconds_of(*stamp_of(time_s)), time_s) << stamp;
  }
  for (const double time_s : {-1e-9, 4294967296.0, std::nan(""), HUGE_VAL}) EXPECT_FALSE(stamp_of(time_s)) << time_s;
}

TEST(LinkCodec, WhatTheWireCannotSayIsRefused) {
  const auto with = [](Body body) { return Message{.device = "D", .body = std::move(body), .metadata = {}}; };
  EXPECT_THAT(refusal({.device = std::string(21, 'd'), .body = GetCapability{}, .metadata = {}}),
              HasSubstr("device name = 21"));
  EXPECT_THAT(refusal({.device = "D", .body = GetCapability{}, .metadata = {{"k", "v"}}}), HasSubstr("version 1"));
  EXPECT_THAT(refusal({.version = 3, .device = "D", .body = GetCapability{}, .metadata = {}}),
              HasSubstr("version = 3"));
  EXPECT_THAT(refusal({.device = "D", .time_s = -1, .body = GetCapability{}, .metadata = {}}), HasSubstr("time = -1"));
  EXPECT_THAT(
      refusal({.version = 2, .device = "D", .body = GetCapability{}, .metadata = {{"k", std::string(65536, 'v')}}}),
      HasSubstr("bytes of metadata = 65537"));
  EXPECT_THAT(refusal(with(Sensor{0, 0, std::vector<double>(256)})), HasSubstr("values of a SENSOR = 256"));
  EXPECT_THAT(refusal(with(String{std::string(65536, 's')})), HasSubstr("STRING = 65536"));
  EXPECT_THAT(refusal(with(TrackingData{{{std::string(21, 't'), 0, {}}}})), HasSubstr("tool's name = 21"));
  EXPECT_THAT(refusal(with(PolyData{{{NAN, 0, 0}}, {}})), HasSubstr("not finite"));
  EXPECT_THAT(refusal(with(PolyData{{{0, 0, 0}}, {{0, 1}}})), HasSubstr("point 1"));
  EXPECT_THAT(refusal(with(PolyData{std::vector<std::array<float, 3>>(22000), {}})), HasSubstr("POLYDATA = 264040"));
  EXPECT_THAT(refusal(with(Skipped{"IMAGE"})), HasSubstr("IMAGE"));
}

}  // namespace
}  // namespace palpate::link::test
