// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <palpate/ndi/faults.hpp>
#include <palpate/ndi/reply_buffer.hpp>

namespace palpate::ndi {

namespace {

constexpr std::byte kFirstOfBx{0xC4}, kCarriageReturn{0x0D};
constexpr std::size_t kLongestText = 4096;  // PHSR with 255 handles has 1283

}  // namespace

std::optional<Reply> ReplyBuffer::take() {
  if (bytes_.empty()) return std::nullopt;
  try {
    return bytes_.front() == kFirstOfBx ? take_bx() : take_text();
  } catch (const MalformedReply&) {
    clear();
    throw;
  }
}

std::optional<Reply> ReplyBuffer::take_bx() {
  if (bytes_.size() < kBxHead) return std::nullopt;
  const std::size_t size = bx_size(bytes_);
  if (bytes_.size() < size) return std::nullopt;
  Reply out = decode_bx(std::span(bytes_).first(size));
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(size));
  return out;
}

std::optional<Reply> ReplyBuffer::take_text() {
  const auto end = std::find(bytes_.begin(), bytes_.end(), kCarriageReturn);
  if (end == bytes_.end()) {
    if (bytes_.size() > kLongestText)
      throw MalformedReply(fmt::format("reply: no end within {} characters", kLongestText));
    return std::nullopt;
  }
  Reply out =
      decode_text({reinterpret_cast<const char*>(bytes_.data()), static_cast<std::size_t>(end - bytes_.begin())});
  bytes_.erase(bytes_.begin(), end + 1);
  return out;
}

}  // namespace palpate::ndi
