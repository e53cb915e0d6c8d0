// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <tests/link/example_messages.hpp>

namespace palpate::serve_test {

/// Messages that lie, nearly all with a valid CRC: each makes its stream of no further use.
inline std::vector<link::test::Bytes> liars() {
  using link::test::Bytes;
  using link::test::raw_message;
  std::vector<Bytes> out;
  const auto claim = [&](const std::string& type, std::uint64_t body_bytes, std::uint16_t version = 1) {
    link::ByteWriter header(out.emplace_back());
    link::write_header({version, type, "Liar", 0.0, body_bytes, 0}, header);
  };
  const auto numbers = [&](const std::string& type, std::initializer_list<std::uint32_t> values) {
    Bytes body;
    link::ByteWriter writer(body);
    for (const std::uint32_t value : values) writer.u32(value);
    out.push_back(raw_message(type, body));
  };
  const std::pair<const char*, std::size_t> lengths[] = {
      {"TRANSFORM", 0}, {"TRANSFORM", 47}, {"TRANSFORM", 96},  {"TDATA", 69},     {"POSITION", 11}, {"QTDATA", 51},
      {"STATUS", 29},   {"STRING", 3},     {"SENSOR", 0},      {"SENSOR", 9},     {"SENSOR", 2051}, {"POLYDATA", 39},
      {"STT_TDATA", 4}, {"STP_TDATA", 1},  {"GET_CAPABIL", 1}, {"CAPABILITY", 11}};
  for (const auto& [type, size] : lengths) out.emplace_back(raw_message(type, Bytes(size)));
  for (const char* const type : {"TRANSFORM", "IMAGE", "POLYDATA"}) claim(type, 1U << 30);
  claim("IMAGE", std::numeric_limits<std::uint64_t>::max());
  claim("STRING", 1U << 20, 2);
  claim("TRANSFORM", 48, 0);
  claim("TRANSFORM", 48, 3);
  claim("", 48);
  claim("IMA\x01GE", 48);
  const std::uint32_t most = std::numeric_limits<std::uint32_t>::max();
  numbers("POLYDATA", {1, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  numbers("POLYDATA", {0x55555556, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2});
  numbers("POLYDATA", {0, most, most, most, most, most, most, most, most, most});
  numbers("POLYDATA", {0, 0, 0, 1, 8, 0, 0, 0, 0, 0, 1, 0});
  out.push_back(raw_message("TRANSFORM", Bytes(60, std::byte{0xFF}), 2));
  out.emplace_back(77, std::byte{0xFF});
  out.push_back(raw_message("TRANSFORM", Bytes(48)));
  out.back().back() ^= std::byte{1};  // a wrong CRC
  return out;
}

}  // namespace palpate::serve_test
