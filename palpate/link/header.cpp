// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <palpate/link/header.hpp>
#include <palpate/link/text.hpp>

namespace palpate::link {

namespace {

constexpr double kEndOfTime_s = 4294967296.0;  // 2^32: February 2106

struct Pair {
  std::size_t key_bytes = 0, value_bytes = 0;
};

std::size_t bytes_of(const Metadata& metadata) {
  std::size_t bytes = 0;
  for (const auto& [key, value] : metadata) bytes += key.size() + value.size();
  return bytes;
}

std::string read_metadata(std::span<const std::byte> head, std::span<const std::byte> data, Metadata& metadata) {
  ByteReader in(head);
  const std::size_t count = head.empty() ? 0 : in.u16();  // some senders leave the count out where there is no pair
  if (count > kMostMetadata) return fmt::format("metadata: {} pairs: expected at most {}", count, kMostMetadata);
  if (!head.empty() && head.size() != 2 + 8 * count)
    return fmt::format("METADATA_HEADER_SIZE = {}: expected {} for {} pairs", head.size(), 2 + 8 * count, count);
  std::vector<Pair> pairs(count);
  std::uint64_t sum = 0;
  for (Pair& pair : pairs) {
    pair.key_bytes = in.u16();
    in.u16();  // the value's encoding
    pair.value_bytes = in.u32();
    sum += pair.key_bytes + pair.value_bytes;
  }
  if (sum != data.size()) return fmt::format("METADATA_SIZE = {}: expected {}", data.size(), sum);
  ByteReader text(data);
  for (const Pair& pair : pairs) {
    std::string key = text.raw(pair.key_bytes);
    metadata.emplace_back(std::move(key), text.raw(pair.value_bytes));
  }
  return {};
}

}  // namespace

double seconds_of(std::uint64_t stamp) {
  const double time_s = std::ldexp(static_cast<double>(stamp), -32);
  return time_s < kEndOfTime_s ? time_s : std::nextafter(kEndOfTime_s, 0.0);  // the last stamps round up
}

std::optional<std::uint64_t> stamp_of(double time_s) {
  if (!(time_s >= 0.0 && time_s < kEndOfTime_s)) return std::nullopt;
  return static_cast<std::uint64_t>(std::round(std::ldexp(time_s, 32)));
}

Header read_header(ByteReader in) {
  Header header;
  header.version = in.u16();
  header.type = in.field(kTypeBytes);
  header.device = in.field(kDeviceBytes);
  header.time_s = seconds_of(in.u64());
  header.body_bytes = in.u64();
  header.crc = in.u64();
  return header;
}

void write_header(const Header& header, ByteWriter& out) {
  out.u16(header.version);
  out.field(header.type, kTypeBytes);
  out.field(header.device, kDeviceBytes);
  out.u64(stamp_of(header.time_s).value_or(0));
  out.u64(header.body_bytes);
  out.u64(header.crc);
}

std::string split_body(std::span<const std::byte> body, std::span<const std::byte>& content, Metadata& metadata) {
  ByteReader in(body);
  const std::size_t extended = in.u16();
  const std::size_t head = in.u16();
  const std::uint64_t data = in.u32();
  if (!in.ok() || extended < kExtendedHeaderBytes || extended > kMostExtendedHeaderBytes)
    return fmt::format("EXT_HEADER_SIZE = {}: expected {} to {}", extended, kExtendedHeaderBytes,
                       kMostExtendedHeaderBytes);
  if (data > kMostMetadataBytes)
    return fmt::format("METADATA_SIZE = {}: expected at most {}", data, kMostMetadataBytes);
  if (extended + head + data > body.size())
    return fmt::format("extended header and metadata of {} bytes in a body of {}", extended + head + data, body.size());
  content = body.subspan(extended, body.size() - extended - head - data);
  return read_metadata(body.subspan(extended + content.size(), head), body.last(data), metadata);
}

void write_extended_header(const Metadata& metadata, ByteWriter& out) {
  out.u16(kExtendedHeaderBytes);
  out.u16(static_cast<std::uint16_t>(2 + 8 * metadata.size()));
  out.u32(static_cast<std::uint32_t>(bytes_of(metadata)));
  out.u32(0);  // MSG_ID: none
}

void write_metadata(const Metadata& metadata, ByteWriter& out) {
  out.u16(static_cast<std::uint16_t>(metadata.size()));
  for (const auto& [key, value] : metadata) {
    out.u16(static_cast<std::uint16_t>(key.size()));
    out.u16(encoding_of(value));
    out.u32(static_cast<std::uint32_t>(value.size()));
  }
  for (const auto& [key, value] : metadata) {
    out.raw(key);
    out.raw(value);
  }
}

}  // namespace palpate::link
