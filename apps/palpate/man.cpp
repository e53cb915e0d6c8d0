// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <list>
#include <memory>
#include <palpate/math/errors.hpp>
#include <palpate/recording/output_file.hpp>
#include <palpate/recording/text_table.hpp>

#include "file_paths.hpp"
#include "man_page.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

struct Options {
  std::vector<std::string> command;
  std::string out;
};

/// Of today, or of SOURCE_DATE_EPOCH: then the same program makes the same bytes.
std::string page_date() {
  std::time_t now = std::time(nullptr);
  if (const char* given = std::getenv("SOURCE_DATE_EPOCH")) {
    const std::string_view text = given;
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), now);
    if (error != std::errc{} || rest != text.data() + text.size())
      throw InputError(fmt::format("SOURCE_DATE_EPOCH = {}: expected seconds since 1970", printable(text)));
  }
  std::tm day{};
  if (::gmtime_r(&now, &day) == nullptr) throw InputError("SOURCE_DATE_EPOCH: expected a time of the calendar");
  return fmt::format("{:04}-{:02}-{:02}", day.tm_year + 1900, day.tm_mon + 1, day.tm_mday);
}

const CommandInfo& find(const std::vector<const CommandInfo*>& all, const std::vector<std::string>& path) {
  for (const CommandInfo* command : all)
    if (command->path == path) return *command;
  std::string words;
  for (const std::string& word : path) words.append(1, ' ').append(printable(word));
  throw InputError(fmt::format("man{}: expected a command of palpate, as palpate --help lists them", words));
}

/// palpate.1, palpate-estimate.1, ...: all of them, or none.
void write_pages(const std::vector<const CommandInfo*>& all, const std::string& folder) {
  if (std::error_code ignored; !std::filesystem::is_directory(folder, ignored))
    throw InputError(fmt::format("--out {}: expected a folder that exists", folder));
  const std::string date = page_date();
  std::list<OutputFile> files;
  for (const CommandInfo* command : all)
    files.emplace_back(std::filesystem::path(folder) / (full_name(*command, "-").append(".1")))
        .write(man_page(*command, date));
  for (OutputFile& file : files) file.commit();
}

}  // namespace

void add_man(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("man", "The manual page of a command, made of its --help");
  verb->group("");
  CLI::Option* command =
      verb->add_option("COMMAND", options->command, "as in identify noise; nothing for palpate itself");
  verb->add_option("--out", options->out, "write every page into this folder")->type_name("FOLDER")->excludes(command);
  verb->footer(
      "Example: palpate man estimate | man -l -\n"
      "         palpate man --out share/man/man1");
  verb->callback([options, verb, &app, &exit_code] {
    refuse_empty_values(*verb);
    const CommandInfo palpate = command_tree(app);
    const std::vector<const CommandInfo*> all = all_commands(palpate);
    if (options->out.empty())
      fmt::print("{}", man_page(find(all, options->command), page_date()));
    else
      write_pages(all, options->out);
    exit_code = 0;
  });
}

}  // namespace palpate::app
