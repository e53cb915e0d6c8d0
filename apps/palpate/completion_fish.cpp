// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "completion.hpp"

namespace palpate::app {

namespace {

constexpr const char* kHead = R"sh(# SPDX-License-Identifier: Apache-2.0
# Fish completion of palpate, made by: palpate completion fish

# True where the words typed so far name this command, "/identify/noise", and none below it.
function __palpate_at
  set -l command
  for word in (commandline -opc)[2..-1]
    if contains -- "$command/$word" $__palpate_commands
      set command "$command/$word"
    end
  end
  test "$command" = "$argv[1]"
end

)sh";

std::string key(const CommandInfo& command) {
  std::string path;
  for (const std::string& word : command.path) path += "/" + word;
  return path;
}

/// Inside single quotes fish reads \\ and \' as escapes.
std::string fish_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\\' || c == '\'') out += '\\';
    out += c;
  }
  return out + "'";
}

std::string value(const ArgumentInfo& argument) {
  switch (argument.kind) {
    case ValueKind::kNone:
      return "";
    case ValueKind::kFile:
      return " -r -F";
    case ValueKind::kFolder:
      return " -x -a '(__fish_complete_directories)'";
    case ValueKind::kWords:
      return fmt::format(" -x -a '{}'", fmt::join(argument.words, " "));
    default:
      return " -x";
  }
}

std::string option_line(const std::string& where, const ArgumentInfo& option) {
  std::string line = where;
  for (const std::string& name : option.names)
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  return line + value(option) + " -d " + fish_quoted(option.about) + "\n";
}

std::string lines_of(const CommandInfo& command) {
  const std::string where = fmt::format("complete -c palpate -n \"__palpate_at '{}'\"", key(command));
  std::string lines;
  for (const CommandInfo& below : command.commands)
    lines += fmt::format("{} -f -a {} -d {}\n", where, fish_quoted(below.path.back()), fish_quoted(below.about));
  const std::vector<ArgumentInfo>& arguments = command.positionals;
  if (arguments.empty() || arguments[0].kind == ValueKind::kOther)
    lines += where + " -f\n";
  else if (arguments[0].kind == ValueKind::kWords)
    lines += where + fmt::format(" -f -a '{}'\n", fmt::join(arguments[0].words, " "));
  else
    lines += where + " -F\n";
  for (const ArgumentInfo& option : command.options) lines += option_line(where, option);
  return lines;
}

}  // namespace

std::string fish_completion(const CommandInfo& palpate) {
  const std::vector<const CommandInfo*> commands = all_commands(palpate);
  std::vector<std::string> keys;
  for (const CommandInfo* command : commands)
    if (!command->path.empty()) keys.push_back(key(*command));
  std::string script = kHead + fmt::format("set -g __palpate_commands {}\n\n", fmt::join(keys, " "));
  for (const CommandInfo* command : commands) script += lines_of(*command);
  return script;
}

}  // namespace palpate::app
