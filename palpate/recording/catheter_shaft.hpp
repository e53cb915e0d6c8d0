// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/toml_table.hpp>
#include <palpate/sensing/catheter.hpp>
#include <string>
#include <vector>

namespace palpate {

/// Adds "read but not yet acted on" to the warnings where `matters`.
void warn_not_acted_on(const TomlTable& table, std::string_view key, bool matters, std::string_view instead,
                       std::vector<std::string>& warnings);

/// [catheter], [[catheter.section]] and [gravity] of a catheter file: the shaft and how well it is known.
void read_shaft(const TomlTable& root, Catheter& catheter, std::vector<std::string>& warnings);

}  // namespace palpate
