// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "completion.hpp"

namespace palpate::app {

namespace {

/// "_palpate_identify_noise"
std::string function_name(const CommandInfo& command) { return "_" + full_name(command, "_"); }

/// Text inside a spec of _arguments or _describe, where colons and brackets part its fields.
std::string spec_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == ':' || c == '[' || c == ']' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string action(const ArgumentInfo& argument) {
  switch (argument.kind) {
    case ValueKind::kFile:
      return "_files";
    case ValueKind::kFolder:
      return "_files -/";
    case ValueKind::kWords:
      return fmt::format("({})", fmt::join(argument.words, " "));
    default:
      return " ";
  }
}

std::string option_specs(const ArgumentInfo& option) {
  std::string lines;
  for (const std::string& name : option.names) {
    std::string spec = option.repeats ? "*" : "";
    spec += name;
    if (option.kind != ValueKind::kNone && name.starts_with("--")) spec += "=";
    spec += fmt::format("[{}]", spec_text(option.about));
    if (option.kind != ValueKind::kNone) spec += fmt::format(":{}:{}", spec_text(option.type), action(option));
    lines += fmt::format(" \\\n    {}", shell_quoted(spec));
  }
  return lines;
}

std::string leaf(const CommandInfo& command) {
  std::string text = fmt::format("{}() {{\n  _arguments", function_name(command));
  for (const ArgumentInfo& option : command.options) text += option_specs(option);
  for (std::size_t i = 0; i < command.positionals.size(); ++i) {
    const ArgumentInfo& argument = command.positionals[i];
    text += fmt::format(" \\\n    {}",
                        shell_quoted(fmt::format("{}:{}:{}", argument.repeats ? "*" : fmt::format("{}", i + 1),
                                                 spec_text(argument.names.at(0)), action(argument))));
  }
  return text + "\n}\n\n";
}

/// A command with commands below it: the first word is one of them, or its own argument.
std::string branch(const CommandInfo& command) {
  std::string text = fmt::format(
      "{}() {{\n  local -a commands line\n  local state context\n  typeset -A opt_args\n"
      "  commands=(\n",
      function_name(command));
  for (const CommandInfo& below : command.commands)
    text += fmt::format("    {}\n", shell_quoted(below.path.back() + ":" + spec_text(below.about)));
  text += "  )\n  _arguments -C";
  for (const ArgumentInfo& option : command.options) text += option_specs(option);
  text +=
      " \\\n    '1:command:->command' \\\n    '*::argument:->argument'\n  case $state in\n    command)\n"
      "      _describe command commands\n";
  if (!command.positionals.empty()) text += "      _files\n";
  text += "      ;;\n    argument)\n      case $line[1] in\n";
  for (const CommandInfo& below : command.commands)
    text += fmt::format("        {}) {} ;;\n", below.path.back(), function_name(below));
  return text + "      esac\n      ;;\n  esac\n}\n\n";
}

}  // namespace

std::string zsh_completion(const CommandInfo& palpate) {
  std::string script =
      "#compdef palpate\n# SPDX-License-Identifier: Apache-2.0\n# Zsh completion of palpate, made by: palpate "
      "completion "
      "zsh\n\n";
  for (const CommandInfo* command : all_commands(palpate))
    script += command->commands.empty() ? leaf(*command) : branch(*command);
  return script + "_palpate \"$@\"\n";
}

}  // namespace palpate::app
