// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/session/export.hpp>

#include "file_paths.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

struct Options {
  std::string session, out, format = "csv", catheter;
  bool json = false;
};

session::ExportFormat format_of(const std::string& word) {
  static const std::map<std::string, session::ExportFormat> formats{{"csv", session::ExportFormat::kCsv},
                                                                    {"igs.mha", session::ExportFormat::kPlusSequence},
                                                                    {"hdf5", session::ExportFormat::kHdf5}};
  const auto found = formats.find(word);
  if (found == formats.end()) throw InputError(fmt::format("--format {}: expected csv, igs.mha or hdf5", word));
  return found->second;
}

int run(const Options& options) {
  const session::ExportFormat format = format_of(options.format);
  check_paths({{"SESSION", "the session", options.session}}, {{"--out", options.out}});
  session::ExportReport report = session::export_session(options.session, options.out, format, options.catheter);
  if (report.rounded > 0)
    report.warnings.push_back(
        fmt::format("{}: {} lengths in metres have no number of millimetres that reads back to the last bit: the "
                    "nearest was written",
                    options.session, report.rounded));
  print_warnings(report.warnings);
  if (options.json) {
    const nlohmann::json out{
        {"files", report.files}, {"frames", report.frames}, {"rounded", report.rounded}, {"warnings", report.warnings}};
    fmt::print("{}\n", out.dump(2));
    return 0;
  }
  fmt::print("{} frames written to\n", report.frames);
  for (const std::string& file : report.files) fmt::print("  {}\n", file);
  return 0;
}

}  // namespace

void add_export(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("export", "Write a recorded session as CSV, PLUS sequence or HDF5");
  verb->add_option("session", options->session, "session, from palpate record or serve")->type_name("FILE")->required();
  verb->add_option("--out", options->out, "what the names of the files begin with")->type_name("PATH")->required();
  verb->add_option("--format", options->format, "igs.mha is for PLUS and 3D Slicer")
      ->type_name("csv|igs.mha|hdf5")
      ->capture_default_str();
  verb->add_option("--catheter", options->catheter, "one catheter of several, by its name")->type_name("NAME");
  verb->add_flag("--json", options->json, "print what was written as JSON");
  verb->footer("Example: palpate export run.palpate --out run --format csv");
  verb->callback([options, verb, &exit_code] {
    refuse_empty_values(*verb);
    exit_code = run(*options);
  });
}

}  // namespace palpate::app
