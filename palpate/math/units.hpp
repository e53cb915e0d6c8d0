// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

/// Conversions for the edge of the program (files, screen). Inside, everything is SI.
namespace palpate {

inline constexpr double kMetresPerMillimetre = 1e-3;
inline constexpr double kMillimetresPerMetre = 1e3;
inline constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
inline constexpr double kGramsForcePerNewton = 1e3 / 9.80665;

}  // namespace palpate
