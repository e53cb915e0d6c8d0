// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <palpate/link/byte_reader.hpp>
#include <palpate/link/byte_writer.hpp>
#include <string>
#include <utility>
#include <vector>

namespace palpate::link {

inline constexpr std::size_t kHeaderBytes = 58;
inline constexpr std::size_t kTypeBytes = 12;
inline constexpr std::size_t kDeviceBytes = 20;
inline constexpr std::size_t kExtendedHeaderBytes = 12;       ///< the least of a version 2 message
inline constexpr std::size_t kMostExtendedHeaderBytes = 256;  ///< a later protocol may add fields
inline constexpr std::size_t kMostMetadata = 256;             ///< pairs of key and value
inline constexpr std::size_t kMostMetadataBytes = 64 * 1024;  ///< all keys and values of a message

/// The first 58 bytes of a message: V uint16, TYPE char[12], DEVICE_NAME char[20], TIME_STAMP, BODY_SIZE, CRC uint64.
struct Header {
  std::uint16_t version = 1;
  std::string type, device;
  double time_s = 0.0;
  std::uint64_t body_bytes = 0, crc = 0;
};

Header read_header(ByteReader in);
void write_header(const Header& header, ByteWriter& out);

/// Seconds since 1970 as the wire has them: unsigned 32.32 fixed point. A double holds 53 of its 64 bits (0.24 us in
/// this century).
double seconds_of(std::uint64_t stamp);
/// The nearest stamp; empty outside [0, 2^32) s.
std::optional<std::uint64_t> stamp_of(double time_s);

using Metadata = std::vector<std::pair<std::string, std::string>>;

/// Takes the body of a version 2 message apart: extended header (EXT_HEADER_SIZE uint16, METADATA_HEADER_SIZE uint16,
/// METADATA_SIZE uint32, MSG_ID uint32), content, metadata header (INDEX_COUNT uint16, then for each pair KEY_SIZE
/// uint16, VALUE_ENCODING uint16, VALUE_SIZE uint32), keys and values. Returns what is wrong, empty where nothing is.
std::string split_body(std::span<const std::byte> body, std::span<const std::byte>& content, Metadata& metadata);

/// What stands before and behind the content. The bounds above hold: that is the caller's to check.
void write_extended_header(const Metadata& metadata, ByteWriter& out);
void write_metadata(const Metadata& metadata, ByteWriter& out);

}  // namespace palpate::link
