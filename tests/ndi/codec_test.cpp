// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <palpate/ndi/faults.hpp>
#include <palpate/ndi/reply_buffer.hpp>
#include <palpate/ndi/tools.hpp>
#include <tests/ndi/aurora_simulator.hpp>
#include <tests/seeded_check.hpp>

namespace palpate::ndi {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text.data(), text.size()));
  return {bytes.begin(), bytes.end()};
}

Bytes from_hex(std::string_view text) {
  Bytes out;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] != ' ') out.push_back(static_cast<std::byte>(*parse_hex(text.substr(i++, 2))));
  return out;
}

template <typename Action>
std::string fault_of(const Action& action) {
  try {
    action();
  } catch (const MalformedReply& fault) {
    return fault.what();
  } catch (const LinkLost& lost) {
    return lost.what();
  }
  return "no fault";
}

/// A whole reply by hand. Floats are IEEE 754, lowest byte first: 1.0 = 3F800000, 1.5 = 1.1b x 2^0 = 3FC00000, -2 =
/// C0000000, 100.25 = 1.56640625 x 2^6 = 42C88000, 0.125 = 2^-3 = 3E000000. Checksums by long division in another
/// language (head 433F, body EA56).
constexpr const char* kByHand =
    "C4 A5 39 00 3F 43 "  // start, length 57 = 1 + 42 + 10 + 2 + 2, checksum of the four bytes before it
    "03 "                 // three handles
    "0A 01 "              // 0A is valid: quaternion (1, 0, 0, 0)
    "00 00 80 3F 00 00 00 00 00 00 00 00 00 00 00 00 "
    "00 00 C0 3F 00 00 00 C0 00 80 C8 42 "  // position (1.5, -2, 100.25) mm
    "00 00 00 3E "                          // error 0.125 mm
    "31 00 00 00 78 56 34 12 "              // occupied, initialised, enabled; frame 12345678
    "0B 02 31 00 00 00 78 56 34 12 "        // 0B is missing
    "0C 04 "                                // 0C is disabled: nothing more
    "40 00 "                                // system status: a port has become occupied
    "56 EA";                                // checksum of the 57 bytes

TEST(NdiCodec, TheReplyWrittenByHandIsUnderstood) {
  const BxReply reply = decode_bx(from_hex(kByHand));
  ASSERT_EQ(reply.handles.size(), 3u);
  EXPECT_EQ(reply.system_status, 0x40);
  const HandleReading& valid = reply.handles[0];
  EXPECT_EQ(valid.handle, 0x0A);
  EXPECT_EQ(valid.status, HandleReading::Status::kValid);
  EXPECT_EQ(valid.quaternion_wxyz, Eigen::Vector4f(1, 0, 0, 0));
  EXPECT_EQ(valid.position_mm, Eigen::Vector3f(1.5F, -2.0F, 100.25F));
  EXPECT_EQ(valid.error_mm, 0.125F);
  EXPECT_EQ(valid.port_status, 0x31u);
  EXPECT_EQ(valid.frame_number, 0x12345678u);
  EXPECT_EQ(reply.handles[1].handle, 0x0B);
  EXPECT_EQ(reply.handles[1].status, HandleReading::Status::kMissing);
  EXPECT_EQ(reply.handles[1].frame_number, 0x12345678u);
  EXPECT_EQ(reply.handles[2].status, HandleReading::Status::kDisabled);
}

TEST(NdiCodec, AReadingIsInMetresAndOnlyWhereThereIsAPose) {
  HandleReading reading = decode_bx(from_hex(kByHand)).handles[0];
  const SensorReading seen = sensor_reading(reading);
  EXPECT_EQ(seen.status, SensorReading::Status::kOk);
  EXPECT_TRUE(seen.has_orientation);
  EXPECT_EQ(seen.position_m, 1e-3 * Eigen::Vector3d(1.5, -2.0, 100.25));
  EXPECT_EQ(seen.error_m, 1e-3 * 0.125);
  for (const int bit : {6, 8, 12}) {  // out of volume, broken coil, processing exception
    reading.port_status = 0x31U | 1U << bit;
    EXPECT_EQ(sensor_reading(reading).status, SensorReading::Status::kMissing) << bit;
  }
  reading.port_status = 0x31U | 1U << 7;  // partially out of volume
  EXPECT_EQ(sensor_reading(reading).status, SensorReading::Status::kOk);
  reading.status = HandleReading::Status::kMissing;
  EXPECT_EQ(sensor_reading(reading).status, SensorReading::Status::kMissing);
}

/// Replies that public drivers quote of real devices, and the check value of CRC-16/ARC.
TEST(NdiCodec, ChecksumsAreThoseOfDevices) {
  for (const char* const line : {"OKAYA896", "RESETBE6F", "001414", "040A0010B0010C0010D001ECFB",
                                 "040A01F0B01F0C01F0D01F2DDB", "010A001C1B5", "Testing!A81C"}) {
    const std::string whole = line, text = whole.substr(0, whole.size() - 4);
    EXPECT_EQ(decode_text(whole).text, text);
    EXPECT_EQ(test::long_division(text), *parse_hex(whole.substr(text.size()))) << line;
  }
  EXPECT_EQ(crc16("123456789"), 0xBB3D);
}

TEST(NdiCodec, CommandsCarryTheirChecksum) {
  EXPECT_EQ(command("INIT"), "INIT:E3A5\r");
  EXPECT_EQ(command("BX", "0801"), "BX:080100EC\r");
  EXPECT_EQ(command("PENA", "0AD"), "PENA:0ADAD1E\r");
  EXPECT_EQ(plain_command("BX", "0801"), "BX 0801\r");
}

TEST(NdiCodec, RepliesInText) {
  EXPECT_EQ(decode_text("OKAYA896").kind, TextReply::Kind::kOkay);
  EXPECT_EQ(decode_text("RESETBE6F").kind, TextReply::Kind::kReset);
  const TextReply error = decode_text("ERROR016BC2");
  EXPECT_EQ(error.kind, TextReply::Kind::kError);
  EXPECT_EQ(error_words(error.error_code), "ERROR01: invalid command");
  EXPECT_EQ(error_words(0x0C), "ERROR0C: command not valid in the present mode");
  EXPECT_EQ(error_words(0x25), "ERROR25: features could not be read");
  EXPECT_EQ(error_words(0xF6), "ERRORF6: flash memory could not be read");
  EXPECT_EQ(error_words(0x77), "ERROR77");
  EXPECT_EQ(error_words(0), "ERROR00");
  EXPECT_EQ(fault_of([] { decode_text("OKAYA897"); }), "reply 'OKAYA897': expected the checksum A896");
  EXPECT_THAT(fault_of([] { decode_text("A89"); }), testing::HasSubstr("expected a checksum"));
  EXPECT_THAT(fault_of([] { decode_text(std::string(200, '\x01')); }), testing::StartsWith("reply '????"));
}

TEST(NdiCodec, PortsAndTools) {
  const auto handles = decode_port_handles("020A0010B01F");
  ASSERT_EQ(handles.size(), 2u);
  EXPECT_EQ(handles[1].handle, 0x0B);
  EXPECT_EQ(handles[1].status, 0x01F);
  EXPECT_TRUE(decode_port_handles("00").empty());
  for (const char* const bad : {"", "0", "01", "020A001", "010A0011", "010A0G1", "xx"})
    EXPECT_THAT(fault_of([&] { decode_port_handles(bad); }), testing::StartsWith("PHSR: '")) << bad;
  EXPECT_EQ(decode_port_location("3A123456100201"), (PortLocation{2, 1}));
  EXPECT_EQ(decode_port_location("UNOCCUPIED"), std::nullopt);
  EXPECT_THAT(fault_of([] { decode_port_location("3A12345610020"); }), testing::StartsWith("PHINF: '"));
  EXPECT_THAT(fault_of([] { decode_port_location("3A1234561002-1"); }), testing::StartsWith("PHINF: '"));

  EXPECT_EQ(parse_tool_name("0A"), ToolName(std::uint8_t{0x0A}));
  EXPECT_EQ(parse_tool_name("1-0"), ToolName(PortLocation{1, 0}));
  for (const char* const bad : {"", "A", "0G", "0AB", "-", "1-", "-0", "1-x", "123-0", "+1-0"})
    EXPECT_EQ(parse_tool_name(bad), std::nullopt) << bad;

  const std::vector<Tool> tools{{0x0C, PortLocation{1, 0}}, {0x0A, PortLocation{2, 0}}, {0x0B, PortLocation{1, 1}}};
  EXPECT_EQ(choose_tools(tools, {}, 3), (std::vector<std::uint8_t>{0x0C, 0x0B, 0x0A}));
  EXPECT_EQ(choose_tools(tools, {PortLocation{2, 0}, std::uint8_t{0x0B}}, 2), (std::vector<std::uint8_t>{0x0A, 0x0B}));
  EXPECT_EQ(fault_of([&] {
              choose_tools(tools, {PortLocation{3, 0}}, 1);
            }),
            "no tool 3-0; the device has 0C (port 1-0), 0A (port 2-0), 0B (port 1-1)");
  EXPECT_EQ(fault_of([] { choose_tools({}, {}, 2); }), "2 sensors wanted; the device has none");
}

/// Head and checksums that fit, so that what is behind them is looked at.
Bytes sealed(const Bytes& body) {
  const auto with_sum = [](std::string text) {
    const std::uint16_t sum = test::long_division(text);
    text += static_cast<char>(sum & 0xFF);
    return text + static_cast<char>(sum >> 8);
  };
  std::string head("\xC4\xA5");
  head += static_cast<char>(body.size() & 0xFF);
  head += static_cast<char>(body.size() >> 8);
  return bytes_of(with_sum(head) + with_sum({reinterpret_cast<const char*>(body.data()), body.size()}));
}

TEST(NdiCodec, ALieOfAnyKindIsToldInWords) {
  Bytes reply = from_hex(kByHand);
  const Bytes body(reply.begin() + 6, reply.end() - 2);
  EXPECT_EQ(sealed(body), reply);
  reply[20] ^= std::byte{1};
  EXPECT_THAT(fault_of([&] { decode_bx(reply); }), testing::HasSubstr("of the body: expected"));
  reply = from_hex(kByHand);
  reply[2] = std::byte{0x3A};
  EXPECT_THAT(fault_of([&] { decode_bx(reply); }), testing::HasSubstr("of the head: expected"));
  reply[0] = std::byte{0};
  EXPECT_EQ(fault_of([&] { decode_bx(reply); }), "BX: start A500: expected A5C4");
  Bytes more = body, count = body, status = body;
  more.push_back(std::byte{0});
  EXPECT_EQ(fault_of([&] { decode_bx(sealed(more)); }), "BX: length 58: expected that of 3 handles");
  count[0] = std::byte{2};
  EXPECT_EQ(fault_of([&] { decode_bx(sealed(count)); }), "BX: length 57: expected that of 2 handles");
  status[2] = std::byte{8};
  EXPECT_EQ(fault_of([&] { decode_bx(sealed(status)); }), "BX: status 08 of handle 0A: expected 01, 02 or 04");
  EXPECT_EQ(fault_of([&] { decode_bx(sealed({})); }), "BX: length 0: expected that of 0 handles");
  // FFFF: its head is C4 A5 FF FF, checksum by long division.
  std::string head{"\xC4\xA5\xFF\xFF"};
  const std::uint16_t sum = test::long_division(head);
  head += static_cast<char>(sum & 0xFF);
  head += static_cast<char>(sum >> 8);
  EXPECT_EQ(fault_of([&] { bx_size(bytes_of(head)); }), "BX: length 65535: expected at most 10713");
}

TEST(NdiCodec, RepliesComeInPieces) {
  ReplyBuffer buffer;
  Bytes all = from_hex(kByHand);
  const Bytes text = bytes_of("OKAYA896\r");
  all.insert(all.end(), text.begin(), text.end());
  std::size_t binary = 0, plain = 0;
  for (const std::byte byte : all) {
    buffer.append(std::span(&byte, 1));
    while (const auto reply = buffer.take()) ++(std::holds_alternative<BxReply>(*reply) ? binary : plain);
  }
  EXPECT_EQ(binary, 1u);
  EXPECT_EQ(plain, 1u);
  EXPECT_EQ(buffer.size(), 0u);
}

TEST(NdiCodec, AfterRubbishTheBufferIsEmpty) {
  ReplyBuffer buffer;
  buffer.append(bytes_of("\xC4\xA5 rubbish"));
  EXPECT_THROW(buffer.take(), MalformedReply);
  EXPECT_EQ(buffer.size(), 0u);
  buffer.append(Bytes(5000, std::byte{'x'}));
  EXPECT_THROW(buffer.take(), MalformedReply);
  EXPECT_EQ(buffer.size(), 0u);
}

/// Exactly as many bytes as the codec is given: one read beyond them is seen by the address sanitizer.
void decode_tight(const Bytes& bytes) {
  const std::unique_ptr<std::byte[]> tight(new std::byte[bytes.size()]);
  std::copy(bytes.begin(), bytes.end(), tight.get());
  try {
    decode_bx({tight.get(), bytes.size()});
  } catch (const MalformedReply&) {
  }
}

TEST(NdiCodecProperty, NoMutationIsTakenForTheReply) {
  test::seeded_check("NoMutationIsTakenForTheReply", []() {
    Bytes bytes = from_hex(kByHand);
    const auto at = *rc::gen::inRange<std::size_t>(0, bytes.size());
    bytes[at] ^= static_cast<std::byte>(*rc::gen::inRange(1, 256));
    decode_tight(bytes);
    RC_ASSERT_THROWS_AS(decode_bx(bytes), MalformedReply);  // a CRC-16 sees every burst of up to 16 bits
  });
}

TEST(NdiCodecProperty, NoTruncationIsReadBeyond) {
  test::seeded_check("NoTruncationIsReadBeyond", []() {
    Bytes bytes = from_hex(kByHand);
    bytes.resize(*rc::gen::inRange<std::size_t>(0, bytes.size()));
    decode_tight(bytes);
    RC_ASSERT_THROWS_AS(decode_bx(bytes), MalformedReply);
  });
}

/// Whatever stands under checksums that fit.
TEST(NdiCodecProperty, NoSealedBodyIsReadBeyond) {
  test::seeded_check("NoSealedBodyIsReadBeyond", [](const std::vector<std::uint8_t>& values) {
    Bytes body;
    for (const std::uint8_t value : values) body.push_back(static_cast<std::byte>(value));
    decode_tight(sealed(body));
    Bytes near = from_hex(kByHand);
    near = Bytes(near.begin() + 6, near.end() - 2);
    for (const std::uint8_t value : values) near[value % near.size()] = static_cast<std::byte>(value);
    near.resize(near.size() - std::min(near.size(), values.size()));
    decode_tight(sealed(near));
  });
}

TEST(NdiCodecProperty, AnyStreamIsSurvived) {
  test::seeded_check("AnyStreamIsSurvived", [](const std::vector<std::string>& pieces) {
    ReplyBuffer buffer;
    for (const std::string& piece : pieces) {
      buffer.append(bytes_of(*rc::gen::element<std::string>("", "\xC4\xA5", "\xC4", "OKAYA896\r")));
      buffer.append(bytes_of(piece));
      try {
        while (buffer.take()) {
        }
      } catch (const MalformedReply&) {
        RC_ASSERT(buffer.size() == 0u);
      }
    }
  });
}

}  // namespace
}  // namespace palpate::ndi
