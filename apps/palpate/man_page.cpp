// SPDX-License-Identifier: Apache-2.0
#include "man_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>
#include <palpate/recording/text_table.hpp>

namespace palpate::app {

namespace {

/// Text as roff wants it: no escapes of its own, a minus that can be copied, no line that looks like a request.
std::string roff(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out.starts_with('.') || out.starts_with('\'') ? "\\&" + out : out;
}

std::string bold(std::string_view text) { return "\\fB" + roff(text) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + roff(text) + "\\fR"; }

std::string page_name(const CommandInfo& command) { return full_name(command, "-"); }

/// The examples of a footer, and what else it says.
struct Footer {
  std::vector<std::string_view> examples, notes;
};

Footer read_footer(const std::string& footer) {
  constexpr std::string_view kExample = "Example: ", kAnother = "         ";
  Footer read;
  bool in_examples = false;
  for (const std::string_view line : split(footer, '\n')) {
    in_examples = line.starts_with(kExample) || (in_examples && line.starts_with(kAnother));
    if (in_examples)
      read.examples.push_back(line.substr(kExample.size()));
    else if (!line.empty() && line != "Each command has its own --help.")
      read.notes.push_back(line);
  }
  return read;
}

std::string synopsis(const CommandInfo& command) {
  std::string line = bold(full_name(command)) + " [" + italic("OPTION") + "]...";
  for (const ArgumentInfo& argument : command.positionals) {
    const std::string name = italic(argument.names.at(0)) + (argument.repeats ? "..." : "");
    line += argument.required ? " " + name : " [" + name + "]";
  }
  if (!command.commands.empty())
    line += command.needs_command ? " " + italic("COMMAND") : " [" + italic("COMMAND") + "]";
  return line;
}

std::string argument_head(const ArgumentInfo& argument, bool positional) {
  std::vector<std::string> names;
  for (const std::string& name : argument.names) names.push_back(positional ? italic(name) : bold(name));
  const bool tells_type = !argument.type.empty() && (!positional || argument.type != argument.names.at(0));
  return fmt::format("{}{}{}", fmt::join(names, ", "), tells_type ? " " + italic(argument.type) : "",
                     argument.repeats ? "..." : "");
}

std::string argument_text(const ArgumentInfo& argument) {
  std::string text = roff(argument.about);
  if (argument.required) text += " (required)";
  if (!argument.fallback.empty()) text += fmt::format(" (default: {})", roff(argument.fallback));
  if (!argument.needs.empty()) text += roff(fmt::format(" (with {})", fmt::join(argument.needs, ", ")));
  if (!argument.excludes.empty()) text += roff(fmt::format(" (not with {})", fmt::join(argument.excludes, ", ")));
  return text;
}

void add_arguments(std::string_view heading, const std::vector<ArgumentInfo>& arguments, bool positional,
                   std::string& page) {
  if (arguments.empty()) return;
  page += fmt::format(".SH {}\n", heading);
  for (const ArgumentInfo& argument : arguments)
    page += fmt::format(".TP\n{}\n{}\n", argument_head(argument, positional), argument_text(argument));
}

void add_commands(const CommandInfo& command, std::string& page) {
  if (command.commands.empty()) return;
  page += ".SH COMMANDS\n";
  for (const CommandInfo& below : command.commands)
    page += fmt::format(".TP\n{}(1)\n{}\n", bold(page_name(below)), roff(below.about));
}

void add_lines(std::string_view heading, const std::vector<std::string_view>& lines, std::string& page) {
  if (lines.empty()) return;
  page += fmt::format(".SH {}\n.nf\n", heading);
  for (const std::string_view line : lines) page += roff(line) + "\n";
  page += ".fi\n";
}

std::string see_also(const CommandInfo& command) {
  std::string name = "palpate", text = bold(name) + "(1)";
  for (std::size_t i = 0; i + 1 < command.path.size(); ++i)
    text += fmt::format(", {}(1)", bold(name += "-" + command.path[i]));
  return text;
}

}  // namespace

std::string man_page(const CommandInfo& command, const std::string& date) {
  std::string title = page_name(command);
  for (char& c : title) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::string page = fmt::format(".\\\" SPDX-License-Identifier: Apache-2.0\n.TH {} 1 {} \"palpate {}\" Palpate\n",
                                 roff(title), date, PALPATE_VERSION);
  page += fmt::format(".SH NAME\n{} \\- {}\n", roff(page_name(command)), roff(command.about));
  page += fmt::format(".SH SYNOPSIS\n{}\n", synopsis(command));
  page +=
      ".SH DESCRIPTION\nPalpate estimates the force on a catheter's tip from tracker poses. It is research software: "
      "not "
      "for clinical use.\n";
  add_commands(command, page);
  add_arguments("ARGUMENTS", command.positionals, true, page);
  add_arguments("OPTIONS", command.options, false, page);
  const Footer footer = read_footer(command.footer);
  add_lines("NOTES", footer.notes, page);
  page +=
      ".SH EXIT STATUS\n0: done. 1: ran, and the answer is no. 2: bad input; one line on standard error says where.\n";
  add_lines("EXAMPLES", footer.examples, page);
  if (!command.path.empty()) page += fmt::format(".SH SEE ALSO\n{}\n", see_also(command));
  return page;
}

}  // namespace palpate::app
