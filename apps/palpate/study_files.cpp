// SPDX-License-Identifier: Apache-2.0
#include "study_files.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <palpate/math/errors.hpp>
#include <palpate/recording/output_file.hpp>
#include <palpate/study/identity.hpp>
#include <palpate/study/report.hpp>
#include <palpate/study/transfer.hpp>

#include "file_paths.hpp"
#include "study_run.hpp"

namespace palpate::app {

namespace {

struct Options {
  std::vector<std::string> files;
  std::string file, out, pictures = "svg";
  bool json = false;
};

void warn_if_incomplete(const study::StudyHead& head, const std::string& file) {
  if (head.shards_done < head.shards)
    print_warnings(
        {fmt::format("{}: {} of {} shards are not done", file, head.shards - head.shards_done, head.shards)});
}

int run_export(const Options& options) {
  check_paths({{"FILE", "the results", options.file}}, {{"--out", options.out}});
  const store::Database database = study::open_results(options.file);
  const study::StudyHead head = study::read_head(database);
  if (options.out.empty()) {
    if (options.json) throw InputError("--json: expected --out, for the table itself goes to standard output");
    study::export_csv(database, [](std::string_view piece) { fmt::print("{}", piece); });
    warn_if_incomplete(head, options.file);
    return 0;
  }
  OutputFile file(options.out);
  study::Sha256 hash;
  const std::uint64_t rows = study::export_csv(database, [&](std::string_view piece) {
    file.write(piece);
    hash.add(piece);
  });
  file.commit();
  warn_if_incomplete(head, options.file);
  const std::string sha256 = hash.hexadecimal();
  if (options.json) {
    nlohmann::json json = as_json(head);
    json["rows"] = rows;
    json["sha256"] = sha256;
    fmt::print("{}\n", json_text(json));
  } else {
    fmt::print("{}: {} rows, sha256 {}\n", options.out, rows, sha256);
  }
  return 0;
}

int run_merge(const Options& options) {
  std::vector<InputPath> inputs;
  for (const std::string& file : options.files) inputs.push_back({"FILE", "the results", file});
  check_paths(inputs, {{"--out", options.out}});
  const study::StudyHead head = study::merge_results({options.files.begin(), options.files.end()}, options.out);
  warn_if_incomplete(head, options.out);
  if (options.json)
    fmt::print("{}\n", json_text(as_json(head)));
  else
    fmt::print("{}: {} of {} shards, {} runs, {} of them failed\n", options.out, head.shards_done, head.shards,
               head.runs_done, head.runs_failed);
  return 0;
}

int run_report(const Options& options) {
  if (options.json) {
    fmt::print("{}\n", json_text(as_json(study::read_head(study::open_results(options.file)))));
    return 0;
  }
  check_paths({{"FILE", "the results", options.file}}, {{"--out", options.out}});
  const store::Database database = study::open_results(options.file);
  const study::StudyHead head = study::read_head(database);
  if (head.shards_done == 0) throw InputError(fmt::format("{}: no shard is done: expected at least one", options.file));
  const std::filesystem::path out(options.out);
  std::error_code ignored;
  if (std::filesystem::exists(out, ignored) && !std::filesystem::is_regular_file(out, ignored))
    throw InputError(fmt::format("--out {}: expected a file, for the pictures stand beside it", options.out));
  const study::Report report = study::make_report(database, out.stem().string(), "." + options.pictures);
  OutputFile file(out);
  file.write(report.markdown);
  for (const auto& picture : report.pictures) plot::write_figure(picture.figure, out.parent_path() / picture.name);
  file.commit();
  warn_if_incomplete(head, options.file);
  fmt::print("{}: {} runs, {} pictures\n", options.out, head.runs_done, report.pictures.size());
  return 0;
}

void add_export(CLI::App& study, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = study.add_subcommand("export", "The results as CSV, sorted: same results, same bytes");
  verb->add_option("FILE", options->file, "results of palpate study")->type_name("FILE")->required();
  verb->add_option("--out", options->out, "CSV file; without it the table goes to standard output")->type_name("FILE");
  verb->add_flag("--json", options->json, "print rows and SHA-256 of the file as JSON");
  verb->footer("Example: palpate study export error.study --out error.csv");
  verb->callback([options, &exit_code] { exit_code = run_export(*options); });
}

void add_merge(CLI::App& study, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = study.add_subcommand("merge", "Results of several jobs of one study, in one new file");
  verb->add_option("FILES", options->files, "results of palpate study --shard i/n")->type_name("FILE")->required();
  verb->add_option("--out", options->out, "the new file")->type_name("FILE")->required();
  verb->add_flag("--json", options->json, "print the summary as JSON");
  verb->footer("Example: palpate study merge part1.study part2.study --out all.study");
  verb->callback([options, &exit_code] { exit_code = run_merge(*options); });
}

void add_report(CLI::App& study, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = study.add_subcommand("report", "Every measure against every parameter: Markdown and pictures");
  verb->add_option("FILE", options->file, "results of palpate study, complete or not")->type_name("FILE")->required();
  verb->add_option("--out", options->out, "Markdown file; the pictures stand beside it")
      ->type_name("FILE")
      ->default_val("study.md");
  verb->add_option("--pictures", options->pictures, "svg or png")
      ->check(CLI::IsMember({"svg", "png"}))
      ->capture_default_str();
  verb->add_flag("--json", options->json, "print what the file holds as JSON, and write nothing");
  verb->footer("Example: palpate study report error.study --out error.md");
  verb->callback([options, &exit_code] { exit_code = run_report(*options); });
}

}  // namespace

void add_study_files(CLI::App& study, int& exit_code) {
  add_export(study, exit_code);
  add_merge(study, exit_code);
  add_report(study, exit_code);
}

}  // namespace palpate::app
