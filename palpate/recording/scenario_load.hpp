// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/toml_table.hpp>
#include <palpate/simulation/scenario.hpp>

namespace palpate {

/// [load] of a scenario file. A wall may be placed by the tip, `gap_mm` and `normal_tip`, as the catheter stands
/// unloaded in the first frame: all else of `scenario` must be read before. Without [load] nothing touches the tip.
void read_load(const TomlTable& root, Scenario& scenario);

}  // namespace palpate
