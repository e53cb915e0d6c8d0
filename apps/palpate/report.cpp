// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <memory>
#include <palpate/math/errors.hpp>
#include <palpate/recording/output_file.hpp>
#include <palpate/recording/text_table.hpp>

#include "file_paths.hpp"
#include "report_json.hpp"
#include "report_page.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

void check_paths(const ReportOptions& options) {
  if (options.out.empty()) throw InputError("--out: expected the name of a file, found an empty one");
  std::vector<InputPath> inputs;
  for (const std::string& recording : options.recordings) inputs.push_back({"recording", "the recording", recording});
  if (!options.catheter.empty()) inputs.push_back({"--catheter", "the catheter file", options.catheter});
  if (!options.estimate.empty()) inputs.push_back({"--estimate", "the estimate CSV", options.estimate});
  if (!options.truth.empty()) inputs.push_back({"--truth", "the force CSV", options.truth});
  if (!options.tendon.empty()) inputs.push_back({"--tendon", "the tendon CSV", options.tendon});
  check_paths(inputs, {{"--out", options.out}});
}

std::vector<double> parse_bands(const std::string& text) {
  std::vector<double> edges_g;
  for (const std::string_view word : split(text, ',')) {
    const std::optional<double> edge_g = parse_number(word);
    if (!edge_g || !std::isfinite(*edge_g) || *edge_g <= (edges_g.empty() ? 0.0 : edges_g.back()))
      throw InputError(fmt::format("--bands {}: '{}': expected positive grams-force that rise, as in 5,10,30,40",
                                   printable(text), printable(word)));
    edges_g.push_back(*edge_g);
  }
  if (edges_g.size() > 12) throw InputError(fmt::format("--bands {}: expected at most 12 edges", printable(text)));
  return edges_g;
}

ContactRule parse_contact(double contact_g) {
  if (!(contact_g > 0.0 && contact_g <= 10000.0))
    throw InputError(fmt::format("--contact {}: expected grams-force, more than 0, at most 10000", contact_g));
  return {.on_N = contact_g / kGramsForcePerNewton};
}

std::string file_names(const std::vector<std::string>& paths) {
  std::string names;
  for (const std::string& path : paths)
    names += (names.empty() ? "" : ", ") + std::filesystem::path(path).filename().string();
  return names;
}

void print_summary(const nlohmann::json& figures, const ReportRun& run, const std::string& out, std::size_t bytes) {
  std::size_t measured = 0;
  for (const ForceSize& size : run.sizes) measured += size.measured;
  fmt::print("{} frames, {:.1f} % measured\n", run.rows.size(),
             100.0 * static_cast<double>(measured) / static_cast<double>(run.rows.size()));
  if (const nlohmann::json& peak = figures["peak"]; !peak.is_null()) {
    const double size_N = peak["size_N"].get<double>();
    fmt::print("largest force {:.4f} N ({:.1f} g) at {:.3f} s\n", size_N, size_N * kGramsForcePerNewton,
               peak["time_s"].get<double>());
  }
  double contact_s = 0.0, integral_Ns = 0.0;
  for (const nlohmann::json& contact : figures["contacts"]) {
    contact_s += contact["duration_s"].get<double>();
    integral_Ns += contact["integral_Ns"].get<double>();
  }
  fmt::print("{} contacts, {:.1f} s together, force-time integral {:.4f} N s ({:.1f} g s)\n",
             figures["contacts"].size(), contact_s, integral_Ns, integral_Ns * kGramsForcePerNewton);
  fmt::print("written: {} ({:.2f} MB)\n", out, static_cast<double>(bytes) * 1e-6);
}

/// All that the page shows.
nlohmann::json page_data(const ReportOptions& options, const ReportRun& run, const std::string& title,
                         const nlohmann::json& figures) {
  const auto name_or_null = [](const std::string& path) {
    return path.empty() ? nlohmann::json() : nlohmann::json(file_names({path}));
  };
  return {{"title", title},
          {"version", PALPATE_VERSION},
          {"recording", file_names(options.recordings)},
          {"estimate", name_or_null(options.estimate)},
          {"truth", name_or_null(options.truth)},
          {"curves", curves_json(run)},
          {"shapes", shapes_json(run)},
          {"figures", figures},
          {"health", health_json(run)},
          {"catheter", settings_json(run)}};
}

int run(const ReportOptions& options) {
  check_paths(options);
  const std::vector<double> edges_g = parse_bands(options.bands);
  const ContactRule rule = parse_contact(options.contact_g);
  const ReportRun run = read_report_run(options);
  const std::string title = options.title.empty() ? file_names(options.recordings) : options.title;
  const nlohmann::json figures = figures_json(run, rule, edges_g);
  const std::string page = report_page(title, page_data(options, run, title, figures));
  OutputFile file(options.out);
  file.write(page);
  file.commit();
  print_warnings(run.warnings);
  if (!options.json) {
    print_summary(figures, run, options.out, page.size());
    return 0;
  }
  nlohmann::json json = figures;
  json["report"] = options.out;
  json["bytes"] = page.size();
  json["health"] = health_json(run);
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  return 0;
}

}  // namespace

void add_report(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ReportOptions>();
  CLI::App* verb = app.add_subcommand(
      "report", "One HTML file to read in a browser: force, shape, contacts and health of a recording");
  verb->add_option("recording", options->recordings,
                   "recording, or several of one run, as for palpate estimate; or a session")
      ->type_name("FILE")
      ->required();
  verb->add_option("--catheter", options->catheter, "catheter file (TOML); a session brings its own")
      ->type_name("FILE");
  verb->add_option("--name", options->name, "which catheter of a session that has several")->type_name("NAME");
  verb->add_option("--out", options->out, "HTML file to write")->type_name("FILE")->required();
  verb->add_option("--estimate", options->estimate,
                   "estimate CSV of this recording; without it the force is estimated here")
      ->type_name("FILE");
  verb->add_option("--truth", options->truth, "force CSV of a force sensor, drawn beside the estimate")
      ->type_name("FILE");
  verb->add_option("--tendon", options->tendon, "tendon CSV, as for palpate estimate")->type_name("FILE");
  verb->add_option("--reference", options->reference, "seconds without tip force, as for palpate estimate")
      ->type_name("FROM:TO");
  verb->add_option("--bands", options->bands, "edges of the force bands in grams-force")
      ->type_name("LIST")
      ->capture_default_str();
  verb->add_option("--contact", options->contact_g, "grams-force from which on the tip counts as in contact")
      ->type_name("GRAMS")
      ->capture_default_str();
  verb->add_option("--title", options->title, "heading of the report; the recording's name where absent")
      ->type_name("WORDS");
  verb->add_flag("--json", options->json, "print the figures as JSON");
  verb->footer(
      "Example: palpate report run.tracker.csv --catheter catheter.toml --out run.html\n"
      "         palpate report run.tracker.csv --catheter catheter.toml --estimate run.estimate.csv --truth "
      "run.force.csv --bands 5,20,40 --out run.html\n"
      "         palpate report session.palpate --out session.html");
  verb->callback([options, verb, &exit_code] {
    refuse_empty_values(*verb);
    exit_code = run(*options);
  });
}

}  // namespace palpate::app
