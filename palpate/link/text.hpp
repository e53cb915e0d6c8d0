// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>

namespace palpate::link {

/// Character encodings by their MIBenum (IANA).
inline constexpr std::uint16_t kAscii = 3, kUtf8 = 106;

inline std::uint16_t encoding_of(std::string_view text) {
  const bool ascii = std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  return ascii ? kAscii : kUtf8;
}

}  // namespace palpate::link
