// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/toml_table.hpp>
#include <palpate/sensing/catheter.hpp>

namespace palpate {

/// [[sensor]], [base] and [tracker] of a catheter file. The shaft must have been read: arc lengths are checked against
/// it.
void read_sensors(const TomlTable& root, Catheter& catheter);

}  // namespace palpate
