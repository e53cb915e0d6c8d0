// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <palpate/link/crc64.hpp>

namespace palpate::link {

namespace {

constexpr std::uint64_t kPolynomial = 0x42F0E1EBA9EA3693;

constexpr std::array<std::uint64_t, 256> make_table() {
  std::array<std::uint64_t, 256> table{};
  for (std::uint64_t i = 0; i < table.size(); ++i) {
    std::uint64_t remainder = i << 56;
    for (int bit = 0; bit < 8; ++bit) {
      const bool carry = (remainder >> 63) != 0;
      remainder = (remainder << 1) ^ (carry ? kPolynomial : 0);
    }
    table[i] = remainder;
  }
  return table;
}

constexpr std::array<std::uint64_t, 256> kTable = make_table();

}  // namespace

std::uint64_t crc64(std::span<const std::byte> bytes) {
  std::uint64_t crc = 0;
  for (const std::byte byte : bytes) crc = kTable[(crc >> 56) ^ std::to_integer<std::uint64_t>(byte)] ^ (crc << 8);
  return crc;
}

}  // namespace palpate::link
