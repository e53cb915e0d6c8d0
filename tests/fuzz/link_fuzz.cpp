// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <palpate/link/byte_reader.hpp>
#include <palpate/link/byte_writer.hpp>
#include <palpate/link/codec.hpp>
#include <palpate/link/crc64.hpp>
#include <span>
#include <string>
#include <vector>

/// libFuzzer's entry to the OpenIGTLink codec (tools/fuzz.sh). The first byte of an input says whether CRCs are made
/// right (so that bodies are reached), whether sizes are, and the second how the stream is cut; the rest is the stream.
namespace palpate::link {
namespace {

using Bytes = std::vector<std::byte>;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "link_fuzz: %s\n", what);
  std::abort();
}

/// What a stream decodes to: each message encoded again, then the fault.
struct Outcome {
  std::vector<Bytes> messages;
  std::string fault;
  bool operator==(const Outcome&) const = default;
};

Bytes encoded_again(const Message& message) {
  Bytes bytes;
  if (const auto* const skipped = std::get_if<Skipped>(&message.body)) {
    for (const char c : skipped->type) bytes.push_back(static_cast<std::byte>(c));
  } else {
    encode(message, bytes);
  }
  return bytes;
}

Outcome outcome_of(std::span<const std::byte> stream, std::size_t chunk) {
  Decoder decoder;
  Message message;
  Outcome outcome;
  Decoder::Result result = Decoder::Result::kNeedsMore;
  std::size_t come = 0;
  while (!stream.empty() && result != Decoder::Result::kMalformed) {
    std::span<const std::byte> piece = stream.first(std::min(chunk, stream.size()));
    stream = stream.subspan(piece.size());
    come += piece.size();
    while ((result = decoder.take(piece, message)) == Decoder::Result::kMessage)
      outcome.messages.push_back(encoded_again(message));
    require(decoder.stored_bytes() <= std::max<std::size_t>(2 * come, 64), "more is stored than has come");
  }
  require((result == Decoder::Result::kMalformed) != decoder.fault().empty(), "a fault without words, or words alone");
  outcome.fault = decoder.fault();
  return outcome;
}

void put_number(std::span<std::byte> place, std::uint64_t value) {
  Bytes bytes;
  ByteWriter(bytes).u64(value);
  std::copy(bytes.begin(), bytes.end(), place.begin());
}

/// Walks from header to header. A size beyond the end becomes that of what is left, where that is asked for.
void repair(std::span<std::byte> stream, bool sizes) {
  while (stream.size() >= kHeaderBytes) {
    std::uint64_t size = read_header(ByteReader(stream)).body_bytes;
    const std::size_t left = stream.size() - kHeaderBytes;
    if (size > left && sizes) put_number(stream.subspan(42, 8), size = left);
    if (size > left) return;
    put_number(stream.subspan(50, 8), crc64(stream.subspan(kHeaderBytes, size)));
    stream = stream.subspan(kHeaderBytes + size);
  }
}

void check(std::span<const std::byte> input) {
  if (input.size() < 2) return;
  const auto mode = std::to_integer<unsigned>(input[0]);
  const std::size_t chunk = 1 + std::to_integer<std::size_t>(input[1]);
  Bytes stream(input.begin() + 2, input.end());
  if ((mode & 1) != 0) repair(stream, (mode & 2) != 0);
  const Outcome whole = outcome_of(stream, stream.size() + 1);
  require(outcome_of(stream, chunk) == whole, "pieces give something else than the whole");
  for (const Bytes& bytes : whole.messages) {
    if (bytes.size() < kHeaderBytes) continue;  // passed over
    const Outcome again = outcome_of(bytes, bytes.size());
    require(again.messages.size() == 1 && again.messages[0] == bytes, "what is encoded is not decoded to itself");
  }
}

}  // namespace
}  // namespace palpate::link

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  palpate::link::check(std::as_bytes(std::span(data, size)));
  return 0;
}
