// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <palpate/link/byte_writer.hpp>
#include <palpate/link/codec.hpp>
#include <palpate/link/crc64.hpp>
#include <palpate/link/header.hpp>
#include <span>
#include <string>
#include <vector>

namespace palpate::link::test {

using Bytes = std::vector<std::byte>;

inline Bytes encoded(const Message& message) {
  Bytes bytes;
  encode(message, bytes);
  return bytes;
}

/// A message made by hand: whatever the header says, with the right CRC of the body.
inline Bytes raw_message(const std::string& type, const Bytes& body, std::uint16_t version = 1) {
  Bytes bytes;
  ByteWriter out(bytes);
  write_header({version, type, "Hand", 0.0, body.size(), crc64(body)}, out);
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

/// What a stream holds: its messages, and what is wrong with it.
struct Decoded {
  std::vector<Message> messages;
  std::string fault;
};

inline Decoded decoded(std::span<const std::byte> bytes, std::size_t chunk = std::size_t(-1)) {
  Decoder decoder;
  Decoded result;
  while (!bytes.empty()) {
    std::span<const std::byte> piece = bytes.first(std::min(chunk, bytes.size()));
    bytes = bytes.subspan(piece.size());
    Message message;
    Decoder::Result taken = Decoder::Result::kNeedsMore;
    while ((taken = decoder.take(piece, message)) == Decoder::Result::kMessage) result.messages.push_back(message);
    if (taken == Decoder::Result::kMalformed) break;
  }
  result.fault = decoder.fault();
  return result;
}

inline Matrix example_matrix() {
  return {{0.36f, 0.48f, -0.8f, -0.8f, 0.6f, 0, 0.48f, 0.64f, 0.6f, 12.5f, -7.25f, 1e-3f}};
}

/// One message of each type that is understood.
inline std::vector<Message> example_messages() {
  const auto message = [](const char* device, Body body) {
    return Message{.version = 1, .device = device, .time_s = 1467000000.5, .body = std::move(body), .metadata = {}};
  };
  std::vector<Message> all;
  all.push_back(message("TipToTracker", Transform{example_matrix()}));
  all.push_back(
      message("Tracker", TrackingData{{{"Tip", 2, example_matrix()}, {"AnInstrumentOf20Byte", 4, Matrix{}}}}));
  all.push_back(message("Point", Position{{1, 2, 3}, {}}));
  all.push_back(message("Pose", Position{{1, 2, 3}, {{0.5f, -0.5f, 0.5f, 0.5f}}}));
  all.push_back(message("Tracker", QuaternionTrackingData{{{"Tip", 2, {4, 5, 6}, {0, 0.6f, 0, 0.8f}}}}));
  all.push_back(message("Device", Status{13, -5, "NotReady", "warming up"}));
  all.push_back(message("CatheterHealth", String{R"({"state":"LIVE"})"}));
  all.push_back(message("CatheterForce", Sensor{0, kNewton, {0.1, -0.02, 1e-300, 4e-3, 4e-3, 9e-3}}));
  all.push_back(message("CatheterShape", PolyData{{{0, 0, 0}, {0, 0, 10}, {0, 1, 20}}, {{0, 1, 2}, {2, 0}}}));
  all.push_back(message("Client", StartTracking{50, "CAMERA"}));
  all.push_back(message("Client", StopTracking{}));
  all.push_back(message("Client", GetCapability{}));
  all.push_back(message("Server", Capability{{"TRANSFORM", "TDATA", "TWELVE_BYTES"}}));
  return all;
}

}  // namespace palpate::link::test
