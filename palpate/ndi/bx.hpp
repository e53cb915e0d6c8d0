// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <palpate/sensing/tracker_frame.hpp>
#include <span>
#include <vector>

namespace palpate::ndi {

/// What BX is asked for: 0001, transformations and status; 0800, those out of the volume too, so that they can be told
/// from those that are not seen at all.
inline constexpr const char* kBxOptions = "0801";

/// What BX says about one port handle.
struct HandleReading {
  enum class Status : std::uint8_t { kValid = 1, kMissing = 2, kDisabled = 4 };

  std::uint8_t handle = 0;
  Status status = Status::kDisabled;
  Eigen::Vector4f quaternion_wxyz = Eigen::Vector4f::Zero();  ///< kValid alone
  Eigen::Vector3f position_mm = Eigen::Vector3f::Zero();      ///< likewise
  float error_mm = 0.0F;                                      ///< likewise; the device's own indicator
  std::uint32_t port_status = 0;                              ///< PortBits; not where disabled
  std::uint32_t frame_number = 0;                             ///< likewise
};

/// Of HandleReading::port_status, for the Aurora. Bit 7 (partially out of volume) is an optical tracker's; a pose with
/// it is passed on.
namespace port_bits {
inline constexpr std::uint32_t kOccupied = 1U << 0, kInitialised = 1U << 4, kEnabled = 1U << 5, kOutOfVolume = 1U << 6,
                               kBrokenSensor = 1U << 8, kProcessingException = 1U << 12;
}

/// Of BxReply::system_status.
namespace system_bits {
inline constexpr std::uint16_t kPortOccupied = 1U << 6, kPortUnoccupied = 1U << 7, kHardwareFailure = 1U << 4;
}

struct BxReply {
  std::vector<HandleReading> handles;
  std::uint16_t system_status = 0;
};

/// Head of a binary reply, little-endian: A5C4, length of the body, checksum of these four bytes. After it come body
/// and the body's checksum. (ndicapi reads length + 8 bytes in all.)
inline constexpr std::uint16_t kBxStart = 0xA5C4;
inline constexpr std::size_t kBxHead = 6, kBxTail = 2;

/// Body of the longest reply: 255 handles of 42 bytes, their count, the system's status.
inline constexpr std::size_t kMostBody = 1 + 255 * 42 + 2;

/// How long the reply is of which this is the head. Throws MalformedReply on another start, a wrong checksum, a length
/// beyond kMostBody. Precondition: at least kBxHead bytes.
std::size_t bx_size(std::span<const std::byte> head);

/// A whole reply, head and tail included. Every length is checked before anything is read. Throws MalformedReply.
BxReply decode_bx(std::span<const std::byte> reply);

/// Metres, and missing where there is no pose to use: not seen, disabled, out of volume, a broken coil, an exception of
/// the device. Positions and quaternions pass as they are, whatever they hold.
SensorReading sensor_reading(const HandleReading& reading);

}  // namespace palpate::ndi
