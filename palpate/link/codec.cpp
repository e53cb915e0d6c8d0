// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <palpate/link/byte_reader.hpp>
#include <palpate/link/codec.hpp>
#include <palpate/link/crc64.hpp>
#include <palpate/link/decode.hpp>

namespace palpate::link {

namespace {

constexpr std::size_t kKeptBytes = 32 * 1024;  // more than that is given back once a message is done

bool is_name(const std::string& type) {
  return !type.empty() && std::ranges::all_of(type, [](char c) { return c > ' ' && c <= '~'; });
}

/// A mesh may rightly be larger than what is kept; what is larger in another type lies.
bool too_large_to_keep(const Header& header) { return header.type == "POLYDATA" && header.body_bytes > kMostBodyBytes; }

std::string header_fault(const Header& header) {
  if (header.version != 1 && header.version != 2)
    return fmt::format("header version {}: expected 1 or 2", header.version);
  if (!is_name(header.type)) return "TYPE: expected 1 to 12 printable ASCII characters";
  if (header.body_bytes > kMostSkippedBytes)
    return fmt::format("{}: BODY_SIZE = {}: expected at most {}", header.type, header.body_bytes, kMostSkippedBytes);
  const Type* const type = find_type(header.type);
  if (type == nullptr || too_large_to_keep(header)) return {};
  const bool second = header.version == 2;
  const std::size_t least = type->least_bytes + (second ? kExtendedHeaderBytes : 0);
  const std::size_t most = second ? kMostBodyBytes : type->most_bytes;
  if (header.body_bytes < least || header.body_bytes > most)
    return fmt::format("{}: BODY_SIZE = {}: expected {} to {}", header.type, header.body_bytes, least, most);
  return {};
}

/// The body, whole and with the right CRC, as a message.
std::string decode_body(const Header& header, std::span<const std::byte> body, Message& message) {
  std::span<const std::byte> content = body;
  if (header.version == 2) {
    if (std::string fault = split_body(body, content, message.metadata); !fault.empty()) return fault;
  }
  const Type& type = *find_type(header.type);
  if (content.size() < type.least_bytes || content.size() > type.most_bytes)
    return fmt::format("{} bytes: expected {} to {}", content.size(), type.least_bytes, type.most_bytes);
  return type.decode(content, message.body);
}

}  // namespace

/// Takes what is missing of the header or of the body. Memory follows what has come, at most twice as much.
void Decoder::fill(std::span<const std::byte>& bytes) {
  const std::size_t whole = header_ ? static_cast<std::size_t>(header_->body_bytes) : kHeaderBytes;
  const std::size_t taken = std::min(whole - body_.size(), bytes.size());
  if (body_.size() + taken > body_.capacity())
    body_.reserve(std::min(whole, std::max(body_.size() + taken, 2 * body_.capacity())));
  body_.insert(body_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(taken));
  bytes = bytes.subspan(taken);
}

void Decoder::begin() {
  header_ = read_header(ByteReader(body_));
  fault_ = header_fault(*header_);
  skips_ = find_type(header_->type) == nullptr || too_large_to_keep(*header_);
  to_skip_ = skips_ ? header_->body_bytes : 0;
  body_.clear();
}

bool Decoder::finish(Message& message) {
  message = Message{header_->version, std::move(header_->device), header_->time_s, {}, {}};
  if (skips_) {
    message.body = Skipped{std::move(header_->type)};
  } else {
    fault_ = crc64(body_) == header_->crc ? decode_body(*header_, body_, message) : "wrong CRC";
    if (!fault_.empty()) fault_ = fmt::format("{}: {}", header_->type, fault_);
  }
  header_.reset();
  body_.clear();
  if (body_.capacity() > kKeptBytes) body_.shrink_to_fit();
  return fault_.empty();
}

Decoder::Result Decoder::take(std::span<const std::byte>& bytes, Message& message) {
  while (fault_.empty()) {
    if (header_ && skips_) {
      const auto skipped = static_cast<std::size_t>(std::min<std::uint64_t>(to_skip_, bytes.size()));
      bytes = bytes.subspan(skipped);
      to_skip_ -= skipped;
      if (to_skip_ > 0) return Result::kNeedsMore;
    } else {
      fill(bytes);
      if (body_.size() < (header_ ? header_->body_bytes : kHeaderBytes)) return Result::kNeedsMore;
    }
    if (!header_)
      begin();
    else if (finish(message))
      return Result::kMessage;
  }
  return Result::kMalformed;
}

}  // namespace palpate::link
