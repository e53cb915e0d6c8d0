// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <tests/link/example_messages.hpp>

/// Messages that lie, nearly all of them with a valid CRC: every one is malformed or passed over, in bounded memory.
namespace palpate::link::test {
namespace {

using ::testing::HasSubstr;

Bytes body_of(const std::function<void(ByteWriter&)>& write) {
  Bytes body;
  ByteWriter out(body);
  write(out);
  return body;
}

Bytes numbers(std::initializer_list<std::uint32_t> values) {
  return body_of([&](ByteWriter& out) {
    for (const std::uint32_t value : values) out.u32(value);
  });
}

/// A header alone, with whatever size it claims.
Bytes claim(const std::string& type, std::uint64_t body_bytes, std::uint16_t version = 1) {
  return body_of([&](ByteWriter& out) { write_header({version, type, "Liar", 0.0, body_bytes, 0}, out); });
}

std::string fault_of(const Bytes& bytes) {
  const Decoded whole = decoded(bytes);
  EXPECT_TRUE(whole.messages.empty());
  EXPECT_EQ(decoded(bytes, 1).fault, whole.fault);
  return whole.fault;
}

std::string fault_of(const std::string& type, const Bytes& body, std::uint16_t version = 1) {
  return fault_of(raw_message(type, body, version));
}

TEST(LinkMalformed, LengthsThatDoNotBelongToTheType) {
  const std::vector<std::pair<std::string, std::vector<std::size_t>>> lengths{
      {"TRANSFORM", {0, 1, 47, 49, 96}},
      {"TDATA", {1, 69, 71, 1025 * 70}},
      {"POSITION", {0, 11, 13, 16, 27, 29}},
      {"QTDATA", {1, 49, 51, 1025 * 50}},
      {"STATUS", {0, 29}},
      {"STRING", {0, 3}},
      {"SENSOR", {0, 1, 9, 2051}},
      {"POLYDATA", {0, 39}},
      {"STT_TDATA", {0, 4, 35, 37}},
      {"STP_TDATA", {1}},
      {"GET_CAPABIL", {1}},
      {"CAPABILITY", {1, 11, 13, 1025 * 12}},
  };
  for (const auto& [type, sizes] : lengths)
    for (const std::size_t size : sizes) EXPECT_NE(fault_of(type, Bytes(size)), "") << type << " " << size;
}

TEST(LinkMalformed, LengthsInsideThatLie) {
  EXPECT_THAT(fault_of("SENSOR", body_of([](ByteWriter& out) { out.u8(255), out.u8(0), out.u64(0), out.f64(1); })),
              HasSubstr("LARRAY = 255"));
  EXPECT_THAT(fault_of("SENSOR", body_of([](ByteWriter& out) { out.u8(0), out.u8(0), out.u64(0), out.f64(1); })),
              HasSubstr("LARRAY = 0"));
  for (const std::uint16_t length : std::initializer_list<std::uint16_t>{0, 4, 6, 65535})
    EXPECT_THAT(fault_of("STRING", body_of([&](ByteWriter& out) { out.u16(3), out.u16(length), out.raw("five."); })),
                HasSubstr("LENGTH"));
}

TEST(LinkMalformed, PolyDataThatLies) {
  const std::uint32_t most = std::numeric_limits<std::uint32_t>::max();
  const auto fault = [](std::initializer_list<std::uint32_t> values) { return fault_of("POLYDATA", numbers(values)); };
  EXPECT_THAT(fault({1, 0, 0, 0, 0, 0, 0, 0, 0, 0}), HasSubstr("NPOINTS = 1"));
  EXPECT_THAT(fault({most, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3}), HasSubstr("NPOINTS"));
  EXPECT_THAT(fault({0x55555556, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2}), HasSubstr("NPOINTS"));  // times 12 is 8 in 32 bits
  EXPECT_NE(fault({0, 0, 4, 0, 0, 0, 0, 0, 0, 0}), "");
  EXPECT_NE(fault({0, 1, 0, 0, 0, 0, 0, 0, 0, 0}), "");
  EXPECT_NE(fault({0, most, most, most, most, most, most, most, most, most}), "");
  EXPECT_THAT(fault({0, 0, 0, 1, 4, 0, 0, 0, 0, 0, 1}), HasSubstr("line 0: 1 points"));
  EXPECT_THAT(fault({0, 0, 0, 1, 8, 0, 0, 0, 0, 0, 1, 0}), HasSubstr("point 0"));
  EXPECT_THAT(fault({1, 0, 0, 1, 8, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1}), HasSubstr("point 1"));
  EXPECT_THAT(fault({0, 0, 0, 0, 0, 1, 8, 0, 0, 0, most, 0}), HasSubstr("polygon 0"));
  EXPECT_THAT(fault({0, 0, 0, 0, 0, 0, 0, 1, 8, 0, 0, 0}), HasSubstr("behind the last"));
  EXPECT_THAT(fault({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 7}), HasSubstr("attributes"));
  EXPECT_NE(fault({0, 0, 0, 0, 0, 0, 0, 0, 0, most}), "");
  EXPECT_NE(fault({0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0x00010000, 0x00010000}), "");
  EXPECT_NE(fault({0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0x00010000, 0x00016161, 0x61616161}), "");  // a name without an end
  EXPECT_THAT(fault({1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x7FC00000, 0, 0}), HasSubstr("not finite"));
}

TEST(LinkMalformed, MetadataThatLies) {
  const auto fault = [](std::uint16_t extended, std::uint16_t head, std::uint32_t data, const Bytes& rest) {
    Bytes body = body_of([&](ByteWriter& out) { out.u16(extended), out.u16(head), out.u32(data), out.u32(0); });
    body.insert(body.end(), rest.begin(), rest.end());
    return fault_of("GET_CAPABIL", body, 2);
  };
  const Bytes none = body_of([](ByteWriter& out) { out.u16(0); });
  const auto pairs = [](std::uint16_t count, std::uint16_t key, std::uint32_t value) {
    return body_of([&](ByteWriter& out) { out.u16(count), out.u16(key), out.u16(3), out.u32(value), out.raw("kv"); });
  };
  EXPECT_THAT(fault(11, 2, 0, none), HasSubstr("EXT_HEADER_SIZE = 11"));
  EXPECT_THAT(fault(0, 2, 0, none), HasSubstr("EXT_HEADER_SIZE = 0"));
  EXPECT_THAT(fault(65535, 2, 0, none), HasSubstr("EXT_HEADER_SIZE = 65535"));
  EXPECT_THAT(fault(12, 65535, 0, none), HasSubstr("in a body of"));
  EXPECT_THAT(fault(12, 2, 0xFFFFFFFF, none), HasSubstr("METADATA_SIZE"));
  EXPECT_THAT(fault(12, 2, 1, none), HasSubstr("in a body of"));
  EXPECT_THAT(fault(13, 2, 0, none), HasSubstr("in a body of"));
  EXPECT_THAT(fault(12, 1, 0, none), HasSubstr("METADATA_HEADER_SIZE = 1"));
  EXPECT_THAT(fault(12, 10, 2, pairs(2, 1, 1)), HasSubstr("METADATA_HEADER_SIZE = 10"));
  EXPECT_THAT(fault(12, 10, 2, pairs(65535, 1, 1)), HasSubstr("65535 pairs"));
  EXPECT_THAT(fault(12, 10, 2, pairs(1, 65535, 1)), HasSubstr("METADATA_SIZE = 2: expected 65536"));
  EXPECT_THAT(fault(12, 10, 2, pairs(1, 1, 0xFFFFFFFF)), HasSubstr("expected 4294967296"));
  EXPECT_THAT(fault(12, 10, 2, pairs(1, 1, 0)), HasSubstr("expected 1"));
  EXPECT_NE(fault_of("GET_CAPABIL", Bytes(11), 2), "");
  EXPECT_THAT(fault_of("TRANSFORM", raw_message("x", Bytes(48)), 2), HasSubstr("EXT_HEADER_SIZE"));
}

TEST(LinkMalformed, NumbersThatAreNone) {
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_THAT(
      fault_of("SENSOR", body_of([&](ByteWriter& out) { out.u8(1), out.u8(0), out.u64(0), out.f64(-infinite); })),
      HasSubstr("infinite"));
}

TEST(LinkMalformed, HeadersThatAreImpossible) {
  EXPECT_THAT(fault_of(claim("TRANSFORM", 1 << 30)), HasSubstr("BODY_SIZE = 1073741824"));
  EXPECT_THAT(fault_of(claim("IMAGE", 1 << 30)), HasSubstr("BODY_SIZE = 1073741824"));
  EXPECT_THAT(fault_of(claim("POLYDATA", 1 << 30)), HasSubstr("BODY_SIZE = 1073741824"));
  EXPECT_THAT(fault_of(claim("IMAGE", ~std::uint64_t{0})), HasSubstr("18446744073709551615"));
  EXPECT_THAT(fault_of(claim("STRING", 1 << 20, 2)), HasSubstr("expected 16 to 262144"));
  EXPECT_THAT(fault_of(claim("TRANSFORM", 48, 0)), HasSubstr("header version 0"));
  EXPECT_THAT(fault_of(claim("TRANSFORM", 48, 3)), HasSubstr("header version 3"));
  EXPECT_THAT(fault_of(claim("", 48)), HasSubstr("TYPE"));
  EXPECT_THAT(fault_of(claim("IMA\x01GE", 48)), HasSubstr("TYPE"));
  EXPECT_THAT(fault_of(Bytes(58)), HasSubstr("header version"));
  EXPECT_THAT(fault_of(Bytes(58, std::byte{0xFF})), HasSubstr("header version 65535"));
}

TEST(LinkMalformed, WrongCrc) {
  for (const Message& message : example_messages()) {
    Bytes bytes = encoded(message);
    if (bytes.size() == kHeaderBytes) bytes[57] ^= std::byte{1};
    bytes.back() ^= std::byte{1};
    if (bytes.size() == kHeaderBytes) bytes[56] ^= std::byte{1};
    EXPECT_THAT(fault_of(bytes), HasSubstr("wrong CRC"));
  }
}

TEST(LinkMalformed, AFaultStays) {
  Decoder decoder;
  Message message;
  const Bytes bad(58), good = encoded(example_messages()[0]);
  std::span<const std::byte> bytes(bad);
  ASSERT_EQ(decoder.take(bytes, message), Decoder::Result::kMalformed);
  bytes = good;
  EXPECT_EQ(decoder.take(bytes, message), Decoder::Result::kMalformed);
  EXPECT_EQ(bytes.size(), good.size());
}

TEST(LinkMalformed, WhatIsNotUnderstoodIsPassedOver) {
  // Among them those that bring down servers built on the library: BIND and NDARRAY with lying lengths.
  for (const std::string type : {"BIND", "NDARRAY", "IMAGE", "RTS_TDATA", "GET_TRANS", "COLORT", "TRAJ", "x"})
    for (const std::uint16_t version : std::initializer_list<std::uint16_t>{1, 2}) {
      Bytes stream = raw_message(type, Bytes(1001, std::byte{0xFF}), version);
      encode(example_messages()[0], stream);
      const Decoded back = decoded(stream, 100);
      ASSERT_EQ(back.messages.size(), 2U) << type << ": " << back.fault;
      EXPECT_EQ(back.messages[0].body, Body(Skipped{type}));
      EXPECT_EQ(back.messages[1], example_messages()[0]);
    }
}

TEST(LinkMalformed, NoClaimReservesMemory) {
  Decoder decoder;
  Message message;
  const Bytes image = claim("IMAGE", 200 << 20), mesh = claim("POLYDATA", 200 << 20),
              text = claim("POLYDATA", 256 << 10);
  for (const Bytes* header : {&image, &mesh}) {
    decoder = Decoder();
    std::span<const std::byte> bytes(*header);
    ASSERT_EQ(decoder.take(bytes, message), Decoder::Result::kNeedsMore);
    const Bytes megabyte(1 << 20);
    for (int i = 0; i < 200; ++i) {
      bytes = megabyte;
      ASSERT_EQ(decoder.take(bytes, message), i < 199 ? Decoder::Result::kNeedsMore : Decoder::Result::kMessage);
      ASSERT_LE(decoder.stored_bytes(), 1024U);
    }
    EXPECT_TRUE(std::holds_alternative<Skipped>(message.body));
  }
  decoder = Decoder();
  std::span<const std::byte> bytes(text);
  decoder.take(bytes, message);
  EXPECT_LE(decoder.stored_bytes(), 1024U);
  for (std::size_t come = 0; come < (256 << 10) - 1; ++come) {
    const std::byte zero{};
    bytes = {&zero, 1};
    ASSERT_EQ(decoder.take(bytes, message), Decoder::Result::kNeedsMore);
    ASSERT_LE(decoder.stored_bytes(), std::max<std::size_t>(2 * (come + 1), 1024));
  }
  EXPECT_LE(decoder.stored_bytes(), kMostBodyBytes);
}

TEST(LinkMalformed, AMeshOfManyLinesIsPassedOver) {
  // 60 000 lines without a point: four bytes each on the wire, six times that in memory.
  Bytes body = numbers({0, 0, 0, 60000, 240000, 0, 0, 0, 0, 0});
  body.resize(body.size() + 240000);
  const Decoded back = decoded(raw_message("POLYDATA", body));
  ASSERT_EQ(back.messages.size(), 1U) << back.fault;
  EXPECT_EQ(back.messages[0].body, Body(Skipped{"POLYDATA"}));
}

}  // namespace
}  // namespace palpate::link::test
