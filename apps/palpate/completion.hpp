// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "command_tree.hpp"

namespace palpate::app {

/// Completion scripts: commands, options, and behind an option files or the words that it knows. They stand alone: the
/// shell does not run palpate to complete.
std::string bash_completion(const CommandInfo& palpate);
std::string zsh_completion(const CommandInfo& palpate);
std::string fish_completion(const CommandInfo& palpate);

/// In single quotes, as all three shells read them.
std::string shell_quoted(std::string_view text);

}  // namespace palpate::app
