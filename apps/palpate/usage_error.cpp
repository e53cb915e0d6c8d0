// SPDX-License-Identifier: Apache-2.0
#include "usage_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <palpate/recording/nearest_name.hpp>
#include <palpate/recording/text_table.hpp>
#include <string_view>
#include <vector>

#include "command_tree.hpp"

namespace palpate::app {

namespace {

bool contains(const std::vector<std::string_view>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App* any) { return !is_hidden(*any); }))
    names.push_back(verb->get_name());
  return names;
}

/// Hidden ones, too; nullptr where there is none.
const CLI::App* find_command(const CLI::App& app, std::string_view name) {
  const auto found = app.get_subcommands([&](const CLI::App* any) { return any->get_name() == name; });
  return found.empty() ? nullptr : found[0];
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

/// "--name", "--name=value" and "-n", but not "-1".
bool is_option(std::string_view word) {
  return word.size() > 1 && word[0] == '-' &&
         (word[1] == '-' ? word.size() > 2 : std::isalpha(static_cast<unsigned char>(word[1])) != 0);
}

bool takes_a_file(const CLI::App& app) {
  const std::vector<const CLI::Option*> options = app.get_options();
  return std::any_of(options.begin(), options.end(), [](const auto* option) { return option->get_positional(); });
}

std::optional<std::string> explain_unknown_option(const CLI::App& app, const std::string& whose,
                                                  std::span<const char* const> arguments) {
  const std::vector<std::string> names = option_names(app);
  const std::vector<std::string_view> known(names.begin(), names.end());
  for (const std::string_view argument : arguments) {
    const std::string_view word = argument.substr(0, argument.find('='));
    if (is_option(word) && !contains(known, word))
      return fmt::format("{}: expected an option of {}; did you mean {}?", printable(word), whose,
                         nearest_name(word, known));
  }
  return std::nullopt;
}

}  // namespace

namespace {

/// `whose`: the words typed so far, "palpate" or "palpate identify".
std::optional<std::string> explain_unknown_word(const CLI::App& app, const std::string& whose,
                                                std::span<const char* const> arguments) {
  const std::vector<std::string> names = command_names(app);
  if (names.empty()) return explain_unknown_option(app, whose, arguments);
  const std::vector<std::string_view> commands(names.begin(), names.end());
  if (arguments.empty()) return fmt::format("expected one of the commands {}", fmt::join(commands, ", "));
  const std::string_view first = arguments[0];
  if (first.starts_with('-')) return explain_unknown_option(app, whose, arguments.first(1));
  if (const CLI::App* command = find_command(app, first))
    return explain_unknown_word(*command, fmt::format("{} {}", whose, first), arguments.subspan(1));
  if (takes_a_file(app)) return explain_unknown_option(app, whose, arguments);
  return fmt::format("{}: expected one of the commands {}; did you mean {}?", printable(first),
                     fmt::join(commands, ", "), nearest_name(first, commands));
}

}  // namespace

std::optional<std::string> explain_unknown_word(const CLI::App& app, std::span<const char* const> arguments) {
  return explain_unknown_word(app, "palpate", arguments);
}

}  // namespace palpate::app
