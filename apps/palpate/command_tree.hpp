// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace palpate::app {

/// What may stand behind an option, as far as a shell can propose it.
enum class ValueKind { kNone, kFile, kFolder, kWords, kOther };

/// An option or a positional argument, as --help tells it.
struct ArgumentInfo {
  std::vector<std::string> names;  ///< "-h", "--help"; of a positional its one word
  std::string type;                ///< "FILE", "FROM:TO", "ekf|iekf"; empty: a flag
  std::string about, fallback;     ///< description; default value, as text
  ValueKind kind = ValueKind::kNone;
  std::vector<std::string> words;  ///< of kWords
  std::vector<std::string> needs, excludes;
  bool required = false, repeats = false;
};

/// `palpate`, or one of its commands; those without a group are hidden, and left out.
struct CommandInfo {
  std::vector<std::string> path;  ///< "identify", "noise"; empty: palpate itself
  std::string about, footer;
  std::vector<ArgumentInfo> options, positionals;
  std::vector<CommandInfo> commands;
  bool needs_command = false;
};

/// A command that --help does not show.
bool is_hidden(const CLI::App& command);

/// The whole command line, for man pages and completion. A value's type says what it is: FILE and PATH are files,
/// SOURCE may be one, FOLDER is a folder, a|b|c is one of these words; anything else only the user knows.
CommandInfo command_tree(const CLI::App& app);

/// "palpate identify noise", the words joined by `between`.
std::string full_name(const CommandInfo& command, const std::string& between = " ");

/// The command and all below it, in the order of --help.
std::vector<const CommandInfo*> all_commands(const CommandInfo& command);

}  // namespace palpate::app
