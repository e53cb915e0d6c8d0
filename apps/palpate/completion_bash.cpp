// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "completion.hpp"

namespace palpate::app {

namespace {

/// Between the frame's parts stand the tables made of the commands.
constexpr const char* kCommandsHead = R"sh(# SPDX-License-Identifier: Apache-2.0
# Bash completion of palpate, made by: palpate completion bash

# The commands below one, and its options: "$1" is the command, "/identify/noise".
_palpate_words() {
  case "$1" in
)sh";

constexpr const char* kValuesHead = R"sh(  esac
}

# What stands behind an option ("$2"; empty: no option) of a command: file, folder, other, or the words it may be. Fails
# where the option takes no value.
_palpate_value() {
  case "$1 $2" in
)sh";

constexpr const char* kTail = R"sh(    *) return 1 ;;
  esac
}

_palpate_propose() {
  local kind=$1 cur=$2
  case "$kind" in
    file) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -f -- "$cur") ;;
    folder) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- "$cur") ;;
    other) ;;
    *) mapfile -t COMPREPLY < <(compgen -W "$kind" -- "$cur") ;;
  esac
}

_palpate() {
  local cur=${COMP_WORDS[COMP_CWORD]} option="" command="" word kind i
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    word=${COMP_WORDS[i]}
    if [[ $word == "=" ]]; then continue; fi  # bash splits --name=value into three
    if [[ -n $option ]]; then option=""; continue; fi
    if [[ $word == -* ]]; then
      if _palpate_value "$command" "$word" >/dev/null; then option=$word; fi
    elif [[ -n $(_palpate_words "$command/$word") ]]; then
      command+="/$word"
    fi
  done
  if [[ $cur == "=" ]]; then cur=""; fi
  if [[ -n $option ]]; then
    _palpate_propose "$(_palpate_value "$command" "$option")" "$cur"
  elif [[ $cur == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_palpate_words "$command")" -- "$cur")
  else
    kind=$(_palpate_value "$command" "") && _palpate_propose "$kind" "$cur"
    for word in $(_palpate_words "$command"); do
      if [[ $word != -* && $word == "$cur"* ]]; then COMPREPLY+=("$word"); fi
    done
  fi
}
complete -F _palpate palpate
)sh";

std::string key(const CommandInfo& command) {
  std::string path;
  for (const std::string& word : command.path) path += "/" + word;
  return path;
}

std::string value(const ArgumentInfo& argument) {
  switch (argument.kind) {
    case ValueKind::kFile:
      return "file";
    case ValueKind::kFolder:
      return "folder";
    case ValueKind::kWords:
      return fmt::format("{}", fmt::join(argument.words, " "));
    default:
      return "other";
  }
}

std::string words(const CommandInfo& command) {
  std::vector<std::string> all;
  for (const CommandInfo& below : command.commands) all.push_back(below.path.back());
  for (const ArgumentInfo& option : command.options) all.insert(all.end(), option.names.begin(), option.names.end());
  return fmt::format("    {}) echo {} ;;\n", shell_quoted(key(command)),
                     shell_quoted(fmt::format("{}", fmt::join(all, " "))));
}

std::string values(const CommandInfo& command) {
  std::string lines;
  const auto add = [&](const std::string& name, const ArgumentInfo& argument) {
    lines +=
        fmt::format("    {}) echo {} ;;\n", shell_quoted(key(command) + " " + name), shell_quoted(value(argument)));
  };
  if (!command.positionals.empty()) add("", command.positionals[0]);
  for (const ArgumentInfo& option : command.options)
    if (option.kind != ValueKind::kNone)
      for (const std::string& name : option.names) add(name, option);
  return lines;
}

}  // namespace

std::string bash_completion(const CommandInfo& palpate) {
  std::string script = kCommandsHead;
  const std::vector<const CommandInfo*> commands = all_commands(palpate);
  for (const CommandInfo* command : commands) script += words(*command);
  script += kValuesHead;
  for (const CommandInfo* command : commands) script += values(*command);
  return script + kTail;
}

std::string shell_quoted(std::string_view text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace palpate::app
