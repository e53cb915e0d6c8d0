// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/recording/nearest_name.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/reproduction/page.hpp>

#include "file_paths.hpp"
#include "progress_line.hpp"
#include "reproduce_files.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

using reproduction::NamedFigure;
using reproduction::Part;
using reproduction::PartMaker;

struct Options {
  std::string name, out;
  int workers = 2;
  bool json = false;
};

std::vector<const PartMaker*> chosen_parts(const std::string& name) {
  std::vector<const PartMaker*> makers = reproduction::parts_named(name);
  if (!makers.empty()) return makers;
  std::vector<std::string_view> known{"all", "corrections"};
  for (const PartMaker& maker : reproduction::all_parts()) known.push_back(maker.name);
  throw InputError(
      fmt::format("reproduce {}: expected a table or figure of the paper, a correction, or all; did you mean "
                  "{}? palpate reproduce --help lists them",
                  printable(name), nearest_name(name, known)));
}

nlohmann::json as_json(const NamedFigure& named) {
  nlohmann::json panels = nlohmann::json::array();
  for (const plot::Panel& panel : named.figure.panels) {
    nlohmann::json series = nlohmann::json::array();
    for (const plot::Series& s : panel.series) series.push_back({{"label", s.label}, {"x", s.x}, {"y", s.y}});
    panels.push_back({{"x_label", panel.x_label}, {"y_label", panel.y_label}, {"series", std::move(series)}});
  }
  return {{"name", named.name}, {"title", named.figure.title}, {"panels", std::move(panels)}};
}

nlohmann::json as_json(std::span<const PartMaker* const> makers, std::span<const Part> parts) {
  nlohmann::json all = nlohmann::json::array();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    nlohmann::json figures = nlohmann::json::array();
    for (const NamedFigure& figure : parts[i].figures) figures.push_back(as_json(figure));
    all.push_back({{"name", makers[i]->name},
                   {"title", parts[i].title},
                   {"markdown", parts[i].markdown},
                   {"figures", std::move(figures)}});
  }
  return all;
}

int run(const Options& options) {
  const std::vector<const PartMaker*> makers = chosen_parts(options.name);
  if (!options.out.empty()) check_folder(options.out);
  std::vector<Part> parts;
  {
    ProgressLine line("reproduce");
    parts = reproduction::make_parts(makers, options.workers, [&](double share) { line.show(share); });
  }
  if (!options.out.empty()) write_page(options.out, reproduction::page_markdown(makers, parts), parts);
  if (options.json)
    fmt::print("{}\n", as_json(makers, parts).dump(2));
  else if (!options.out.empty())
    fmt::print("{}: {} parts\n", (std::filesystem::path(options.out) / kPageName).string(), parts.size());
  else
    for (const Part& part : parts) fmt::print("## {}\n\n{}\n", part.title, part.markdown);
  return 0;
}

std::string help_footer() {
  std::string text =
      "NAME is one of\n  all                everything, on one page\n  corrections        all corrections\n";
  for (const PartMaker& maker : reproduction::all_parts()) text += fmt::format("  {:18} {}\n", maker.name, maker.about);
  return text +
         "Example: palpate reproduce table3\n"
         "         palpate reproduce all --out paper";
}

}  // namespace

void add_reproduce(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("reproduce", "The paper's tables and figures made again, theirs beside ours");
  verb->add_option("NAME", options->name, "what to reproduce, see below")->required();
  verb->add_option("--out", options->out, "folder to write paper.md and its pictures (SVG) to")->type_name("FOLDER");
  verb->add_option("--workers", options->workers, "threads")->check(CLI::Range(1, 64))->capture_default_str();
  verb->add_flag("--json", options->json, "print tables and the figures' curves as JSON");
  verb->footer(help_footer());
  verb->callback([options, verb, &exit_code] {
    refuse_empty_values(*verb);
    exit_code = run(*options);
  });
}

}  // namespace palpate::app
