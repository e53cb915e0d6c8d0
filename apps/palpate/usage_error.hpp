// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

namespace CLI {
class App;
}

namespace palpate::app {

/// What a typing error in a command or option should say, with the nearest one that exists; none where every word is
/// known. `arguments` without the program's name.
std::optional<std::string> explain_unknown_word(const CLI::App& app, std::span<const char* const> arguments);

}  // namespace palpate::app
