// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <palpate/link/header.hpp>
#include <palpate/link/message.hpp>
#include <span>
#include <string>
#include <vector>

namespace palpate::link {

/// Appends the message to `out`, with header version Message::version. Throws InputError on what the wire cannot say:
/// a device name above 20 bytes, too many values, a body above kMostBodyBytes, a time outside [0, 2^32) s, metadata in
/// version 1, a POLYDATA with points that are not finite or are not there; `out` then is as it was. SENSOR's values and
/// all poses go out as they are, NaN too (a force that is not live).
void encode(const Message& message, std::vector<std::byte>& out);

inline constexpr std::size_t kMostBodyBytes = 256 * 1024;      ///< of a message that is read
inline constexpr std::uint64_t kMostSkippedBytes = 256 << 20;  ///< of one that is passed over, never stored

/// Takes a stream apart into messages. Bounded: no body above kMostBodyBytes is stored whatever a header says, nothing
/// is reserved before it has come. Unknown types (and a POLYDATA too large to keep) are passed over by their length.
/// What lies about its contents or has a wrong CRC is malformed, so is a number that is not finite in POLYDATA or an
/// infinite one in SENSOR: the stream is then of no further use. Poses are passed on as they are, finite or not: the
/// observer screens them.
class Decoder {
 public:
  enum class Result { kNeedsMore, kMessage, kMalformed };

  /// Takes bytes from the front of `bytes` (which shrinks) until a message is complete or all are taken.
  Result take(std::span<const std::byte>& bytes, Message& message);
  const std::string& fault() const { return fault_; }  ///< of a malformed stream, in words
  std::size_t stored_bytes() const { return body_.capacity(); }

 private:
  void fill(std::span<const std::byte>& bytes);
  void begin();
  bool finish(Message& message);

  std::vector<std::byte> body_;  ///< what has come of the header, then of the body
  std::optional<Header> header_;
  std::uint64_t to_skip_ = 0;
  bool skips_ = false;
  std::string fault_;
};

}  // namespace palpate::link
