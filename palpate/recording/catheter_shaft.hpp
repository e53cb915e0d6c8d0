// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/toml_table.hpp>
#include <palpate/sensing/catheter.hpp>

namespace palpate {

/// [catheter], [[catheter.section]] and [gravity] of a catheter file: the shaft and how well it is known.
void read_shaft(const TomlTable& root, Catheter& catheter);

}  // namespace palpate
