// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <palpate/sensing/tendon_map.hpp>
#include <string>
#include <vector>

namespace palpate {

/// Where the handle stands over time: one column of a tendon CSV.
struct HandleTrace {
  std::string source;
  std::vector<double> times_s;   ///< strictly increasing, at least one
  std::vector<double> position;  ///< rad, m or N
  bool has_moments = false;      ///< a moment_1_Nm or moment_2_Nm is filled in somewhere
};

/// Reads `time_s` and the column named as the input: knob_rad, displacement_mm or tension_N; others are passed over.
/// Throws InputError on a column that is not there, a value that is not a finite number, a time that does not increase.
HandleTrace read_handle_csv(const std::filesystem::path& path, TendonInput input);

/// What the handle does at each of `times_s`, in any order: linear between the samples, in the light of all samples
/// before; the nearest sample outside them, counted in `outside`. A time that is not finite gets no bend.
struct BendTrace {
  std::vector<BendReading> bends;
  std::size_t outside = 0;         ///< times before the first or behind the last sample
  std::size_t beyond_the_map = 0;  ///< of the bends: where the handle was beyond the map's ends
};
BendTrace bends_at(const HandleTrace& handle, const TendonPlay& play, const std::vector<double>& times_s);

}  // namespace palpate
