// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/crc.hpp>
#include <charconv>
#include <palpate/ndi/command.hpp>
#include <palpate/ndi/faults.hpp>

namespace palpate::ndi {

namespace {

constexpr std::size_t kChecksumDigits = 4;

/// 01 to 25, in the order of their numbers; what belongs to optical trackers alone is named as theirs.
constexpr std::array<const char*, 0x25> kErrorWords{
    "invalid command",
    "command too long",
    "command too short",
    "wrong checksum of the command",
    "time-out while the command was carried out",
    "new communication parameters could not be set",
    "wrong number of parameters",
    "invalid port handle",
    "invalid tracking priority",
    "invalid LED",
    "invalid LED state",
    "command not valid in the present mode",
    "no tool in the port",
    "port handle not initialised",
    "port handle not enabled",
    "system not initialised",
    "tracking could not be stopped",
    "tracking could not be started",
    "port handle could not be initialised",
    "invalid parameters of the volume or camera",
    "system could not be initialised",
    "diagnostics could not be started",
    "diagnostics could not be stopped",
    "infrared check failed (optical trackers)",
    "firmware revision could not be read",
    "internal error of the device",
    "infrared diagnostics could not be initialised (optical trackers)",
    "marker signature could not be set (optical trackers)",
    "tool memories could not be searched",
    "tool memory could not be read",
    "tool memory could not be written",
    "tool memory could not be selected",
    "tool current test failed",
    "no parameters for this wavelength (optical trackers)",
    "parameter out of range",
    "no parameters for this volume",
    "features could not be read",
};

/// For a message: what is no plain character becomes '?'.
std::string shown(std::string_view text) {
  constexpr std::size_t kMost = 40;
  std::string out(text.substr(0, kMost));
  std::replace_if(
      out.begin(), out.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
  return out + (text.size() > kMost ? "..." : "");
}

int two_digits(std::string_view text) {
  int value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : -1;
}

}  // namespace

std::uint16_t crc16(std::span<const std::byte> bytes) {
  boost::crc_16_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

std::uint16_t crc16(std::string_view text) { return crc16(std::as_bytes(std::span(text.data(), text.size()))); }

std::string command(std::string_view name, std::string_view parameters) {
  const std::string text = fmt::format("{}:{}", name, parameters);
  return fmt::format("{}{:04X}\r", text, crc16(text));
}

std::string plain_command(std::string_view name, std::string_view parameters) {
  return fmt::format("{} {}\r", name, parameters);
}

TextReply decode_text(std::string_view line) {
  if (line.size() < kChecksumDigits)
    throw MalformedReply(fmt::format("reply '{}': expected a checksum of four digits", shown(line)));
  const std::string_view text = line.substr(0, line.size() - kChecksumDigits);
  const auto told = parse_hex(line.substr(text.size()));
  if (!told || *told != crc16(text))
    throw MalformedReply(fmt::format("reply '{}': expected the checksum {:04X}", shown(line), crc16(text)));
  TextReply out{.kind = TextReply::Kind::kData, .text = std::string(text)};
  if (text == "OKAY") out.kind = TextReply::Kind::kOkay;
  if (text == "RESET") out.kind = TextReply::Kind::kReset;
  if (text.size() == 7 && text.starts_with("ERROR"))
    if (const auto code = parse_hex(text.substr(5))) {
      out.kind = TextReply::Kind::kError;
      out.error_code = static_cast<int>(*code);
    }
  return out;
}

std::string error_words(int code) {
  if (code >= 1 && code <= static_cast<int>(kErrorWords.size()))
    return fmt::format("ERROR{:02X}: {}", code, kErrorWords[static_cast<std::size_t>(code - 1)]);
  if (code == 0xF4) return "ERRORF4: flash memory could not be erased";
  if (code == 0xF5) return "ERRORF5: flash memory could not be written";
  if (code == 0xF6) return "ERRORF6: flash memory could not be read";
  return fmt::format("ERROR{:02X}", code);
}

std::optional<std::uint32_t> parse_hex(std::string_view digits) {
  std::uint32_t value = 0;
  if (digits.empty() || digits.size() > 8) return std::nullopt;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

std::string hex_handle(std::uint8_t handle) { return fmt::format("{:02X}", handle); }

std::vector<PortHandle> decode_port_handles(std::string_view text) {
  constexpr std::size_t kEntry = 5;
  const auto refuse = [text] {
    return MalformedReply(fmt::format("PHSR: '{}': no list of port handles", shown(text)));
  };
  const auto count = text.size() < 2 ? std::nullopt : parse_hex(text.substr(0, 2));
  if (!count || text.size() != 2 + kEntry * *count) throw refuse();
  std::vector<PortHandle> out;
  for (std::size_t at = 2; at < text.size(); at += kEntry) {
    const auto handle = parse_hex(text.substr(at, 2)), status = parse_hex(text.substr(at + 2, 3));
    if (!handle || !status) throw refuse();
    out.push_back({static_cast<std::uint8_t>(*handle), static_cast<std::uint16_t>(*status)});
  }
  return out;
}

std::optional<PortLocation> decode_port_location(std::string_view text) {
  constexpr std::size_t kPort = 10, kChannel = 12, kSize = 14;
  if (text.starts_with("UNOCCUPIED")) return std::nullopt;
  const bool whole = text.size() == kSize;
  const PortLocation out{whole ? two_digits(text.substr(kPort, 2)) : -1,
                         whole ? two_digits(text.substr(kChannel)) : -1};
  if (out.port < 0 || out.channel < 0)
    throw MalformedReply(fmt::format("PHINF: '{}': no location of a port", shown(text)));
  return out;
}

}  // namespace palpate::ndi
