// SPDX-License-Identifier: Apache-2.0
#include "command_tree.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <palpate/recording/text_table.hpp>
#include <palpate/reproduction/part.hpp>

namespace palpate::app {

namespace {

/// CLI11 appends what its checks say: "FLOAT:FLOAT in [0.1 - 10]", "TEXT:{svg,png}". The words of a set are the type.
std::string type_of(const CLI::Option& option) {
  std::string type = option.get_type_name();
  if (const std::size_t set = type.find(":{"); set != std::string::npos) {
    type = type.substr(set + 2, type.rfind('}') - set - 2);
    std::replace(type.begin(), type.end(), ',', '|');
  }
  if (const std::size_t range = type.find(" in ["); range != std::string::npos) type.erase(type.find(':'));
  return type;
}

ValueKind kind_of(const std::string& type) {
  if (type.empty()) return ValueKind::kNone;
  if (type == "FILE" || type == "PATH" || type == "SOURCE" || type == "TEXT") return ValueKind::kFile;
  if (type == "FOLDER") return ValueKind::kFolder;
  return type.find('|') == std::string::npos ? ValueKind::kOther : ValueKind::kWords;
}

std::vector<std::string> names_of(const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;
  names.reserve(options.size());
  for (const CLI::Option* option : options) names.push_back(option->get_name());
  std::sort(names.begin(), names.end());  // the set is in the order of addresses
  return names;
}

ArgumentInfo argument_info(const CLI::Option& option) {
  ArgumentInfo info;
  info.about = option.get_description();
  info.fallback = option.get_default_str();
  info.required = option.get_required();
  info.repeats = option.get_expected_max() > 1;
  info.needs = names_of(option.get_needs());
  info.excludes = names_of(option.get_excludes());
  if (option.get_items_expected_max() > 0) info.type = type_of(option);
  info.kind = kind_of(info.type);
  if (info.kind == ValueKind::kWords)
    for (const std::string_view word : split(info.type, '|')) info.words.emplace_back(word);
  if (option.get_positional()) info.names.push_back(option.get_name(true));
  for (const std::string& name : option.get_snames()) info.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) info.names.push_back("--" + name);
  return info;
}

/// They are too many for the line of a type; its footer lists them.
void add_names_of_parts(CommandInfo& reproduce) {
  ArgumentInfo& name = reproduce.positionals.at(0);
  name.type = name.names.at(0);
  name.kind = ValueKind::kWords;
  name.words = {"all", "corrections"};
  for (const reproduction::PartMaker& part : reproduction::all_parts()) name.words.emplace_back(part.name);
}

CommandInfo command_info(const CLI::App& app, std::vector<std::string> path) {
  CommandInfo info;
  info.about = app.get_description();
  info.footer = app.get_footer();
  info.needs_command = app.get_require_subcommand_min() > 0;
  for (const CLI::Option* option : app.get_options())
    (option->get_positional() ? info.positionals : info.options).push_back(argument_info(*option));
  for (const CLI::App* command : app.get_subcommands([](const CLI::App* any) { return !is_hidden(*any); })) {
    std::vector<std::string> below = path;
    below.push_back(command->get_name());
    info.commands.push_back(command_info(*command, std::move(below)));
  }
  info.path = std::move(path);
  if (info.path == std::vector<std::string>{"reproduce"}) add_names_of_parts(info);
  return info;
}

}  // namespace

bool is_hidden(const CLI::App& command) { return command.get_group().empty(); }

CommandInfo command_tree(const CLI::App& app) { return command_info(app, {}); }

std::string full_name(const CommandInfo& command, const std::string& between) {
  std::string name = "palpate";
  for (const std::string& word : command.path) name += between + word;
  return name;
}

std::vector<const CommandInfo*> all_commands(const CommandInfo& command) {
  std::vector<const CommandInfo*> all{&command};
  for (const CommandInfo& below : command.commands)
    for (const CommandInfo* each : all_commands(below)) all.push_back(each);
  return all;
}

}  // namespace palpate::app
