// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <palpate/sensing/catheter.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <string_view>

namespace palpate {

/// Why a reading is not used. Each is counted; none of them touches the estimate. All but kAbsent are faults.
enum class Rejection : std::uint8_t {
  kNone,
  kMissing,    ///< the tracker says so itself
  kNotFinite,  ///< NaN or Inf in the pose
  kZeroQuaternion,
  kNonUnitQuaternion,  ///< |q| off by more than 1 %: not a rotation
  kIdentityPose,       ///< exactly identity: how some drivers report a fault with status OK
  kNoOrientation,      ///< a point where the catheter expects a pose
  kOutlier,            ///< no plausible force explains it together with the other sensors
  kAbsent,             ///< the frame does not speak of this sensor
};
inline constexpr std::size_t kRejections = 9;

/// Short words for summaries: "missing", "not finite", ...
std::string_view describe(Rejection rejection);

/// Checks one reading alone, without regard to any state.
Rejection screen(const SensorReading& reading, SensorKind kind);

}  // namespace palpate
