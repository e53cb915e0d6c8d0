// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace palpate::link {

/// CRC-64 of ECMA-182 as OpenIGTLink has it: polynomial 0x42F0E1EBA9EA3693, most significant bit first, starts at 0,
/// nothing reflected or inverted. No bytes: 0. Source: the protocol's header page. Cost: a table look-up a byte.
std::uint64_t crc64(std::span<const std::byte> bytes);

}  // namespace palpate::link
