// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/toml_edit.hpp>
#include <palpate/recording/toml_table.hpp>
#include <palpate/sensing/catheter.hpp>
#include <string_view>

namespace palpate {

/// [tendon_map] of a catheter file; after [catheter], whose k2,0 stands where the map gives none.
void read_tendon_map(const TomlTable& root, Catheter& catheter);

/// Puts `map` in place of the file's [tendon_map], or adds it; `comment` (one line) goes behind its input.
void write_tendon_map(const TendonMap& map, std::string_view comment, TomlEdit& edit);

/// "knob_rad", "displacement_mm", "tension_N": the words of catheter file and CSV columns.
std::string_view name_of(TendonInput input);

/// By how much a number of a file is to be multiplied to be rad, m or N.
double si_per_unit(TendonInput input);

}  // namespace palpate
