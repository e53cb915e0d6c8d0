// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// The text half of NDI's combined application program interface, as the Aurora speaks it. Facts from NDI's Aurora API
/// guide as cited in public drivers (ndicapi of the PLUS toolkit, drivers for ROS and Python); the guide itself was not
/// at hand, no device was.
namespace palpate::ndi {

/// CRC-16/ARC (x^16 + x^15 + x^2 + 1, reflected, from 0). Checked against replies that public drivers quote of real
/// devices: OKAYA896, RESETBE6F, 040A0010B0010C0010D001ECFB.
std::uint16_t crc16(std::span<const std::byte> bytes);
std::uint16_t crc16(std::string_view text);

/// `NAME:parametersCCCC\r`, CCCC the checksum of what stands before it, in capital hexadecimal digits.
std::string command(std::string_view name, std::string_view parameters = {});
/// `NAME parameters\r`: the same without a checksum.
std::string plain_command(std::string_view name, std::string_view parameters = {});

/// A reply in text, checksum taken off.
struct TextReply {
  enum class Kind : std::uint8_t { kOkay, kReset, kError, kData };
  Kind kind = Kind::kData;
  std::string text;    ///< what stands before the checksum
  int error_code = 0;  ///< of kError
};

/// `line`: without its carriage return. Throws MalformedReply where the checksum is not that of the text.
TextReply decode_text(std::string_view line);

/// What ERRORxx means; of a code that is not known, its number.
std::string error_words(int code);

/// Hexadecimal digits and nothing else, 1 to 8 of them.
std::optional<std::uint32_t> parse_hex(std::string_view digits);
/// Two capital digits.
std::string hex_handle(std::uint8_t handle);

/// An entry of PHSR's reply. Bits of `status`: 0 occupied, 4 initialised, 5 enabled.
struct PortHandle {
  std::uint8_t handle = 0;
  std::uint16_t status = 0;
};

/// `NNHHSSS...`: count, then handle and status. Throws MalformedReply.
std::vector<PortHandle> decode_port_handles(std::string_view text);

/// A physical port of the system control unit. A port may carry two sensors on one plug: channels 0 and 1.
struct PortLocation {
  int port = 0, channel = 0;
  bool operator==(const PortLocation&) const = default;
};

/// Reply to PHINF with option 0020, 14 characters: device number (8), kind of system (1), kind of tool (1), port (2),
/// channel (2); the port counts from 01. Nothing where the port is unoccupied. Throws MalformedReply.
std::optional<PortLocation> decode_port_location(std::string_view text);

}  // namespace palpate::ndi
