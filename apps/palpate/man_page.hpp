// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "command_tree.hpp"

namespace palpate::app {

/// The manual page of one command, in man(7): what its --help says, and what every command shares.
/// `date`: YYYY-MM-DD.
std::string man_page(const CommandInfo& command, const std::string& date);

}  // namespace palpate::app
