// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <palpate/observer/estimate.hpp>
#include <string_view>

namespace palpate::session {

/// The numbers of an estimate that a session keeps, in one row: what is stored, compared and exported by name.
inline constexpr std::size_t kEstimateNumbers = 68;
using EstimateNumbers = std::array<double, kEstimateNumbers>;

/// Name of each, with its unit: columns of table estimate.
const std::array<std::string_view, kEstimateNumbers>& estimate_number_names();
void numbers_of(const Estimate& estimate, EstimateNumbers& numbers);
/// The covariance is filled on both sides of its diagonal from the one that is kept.
void set_numbers(const EstimateNumbers& numbers, Estimate& estimate);

/// The same of what is there only where it was asked for: convergence index, forecast, lagged force.
inline constexpr std::size_t kExtraNumbers = 21;
using ExtraNumbers = std::array<double, kExtraNumbers>;
const std::array<std::string_view, kExtraNumbers>& extra_number_names();
void extra_numbers_of(const Estimate& estimate, ExtraNumbers& numbers);
void set_extra_numbers(const ExtraNumbers& numbers, Estimate& estimate);
/// False: all of it is as in an estimate that nobody has asked for more.
bool has_extra(const Estimate& estimate);

/// Observability's flags as bits: 1 axial force hidden, 2 shaft straight, 4 lateral force hidden, 8 stiffness, 16
/// precurvature rests on the prior.
std::int64_t observability_bits(const Observability& observability);
void set_observability_bits(std::int64_t bits, Observability& observability);

/// Estimate::rejections as hexadecimal digits, the first reading's the lowest; 0: none was rejected.
std::int64_t packed_rejections(const Estimate& estimate);
void set_packed_rejections(std::int64_t packed, Estimate& estimate);

/// "first", "advanced", "resynchronised", "stands still", "steps back", "not finite".
std::string_view describe(FrameTime verdict);
inline constexpr std::size_t kFrameTimes = 6;

/// The same bits, or both NaN: one NaN is as good as another.
bool same_number(double a, double b);

}  // namespace palpate::session
