// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <palpate/ndi/bx.hpp>
#include <palpate/ndi/command.hpp>
#include <variant>

namespace palpate::ndi {

using Reply = std::variant<TextReply, BxReply>;

/// Bytes in, whole replies out. Holds at most one longest reply and what came with it.
class ReplyBuffer {
 public:
  void append(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  void clear() { bytes_.clear(); }
  std::size_t size() const { return bytes_.size(); }

  /// The next reply, or nothing yet. A binary one begins with C4, which no text does. Throws MalformedReply and forgets
  /// everything: what follows cannot be told apart, so wait until the line is quiet and ask again.
  std::optional<Reply> take();

 private:
  std::optional<Reply> take_bx();
  std::optional<Reply> take_text();

  std::vector<std::byte> bytes_;
};

}  // namespace palpate::ndi
