// SPDX-License-Identifier: Apache-2.0
#include "study_run.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <csignal>
#include <optional>
#include <palpate/math/errors.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/study/fingerprint.hpp>
#include <palpate/study/runner.hpp>
#include <palpate/study/scratch_folder.hpp>
#include <palpate/study/study_file.hpp>

#include "file_paths.hpp"
#include "progress_line.hpp"

namespace palpate::app {

namespace {

volatile std::sig_atomic_t stop_asked = 0;
void ask_to_stop(int /*signal*/) { stop_asked = 1; }

/// A signal that the shell has this process ignore (a background job) stays ignored.
void stop_at(int signal) {
  if (std::signal(signal, SIG_IGN) != SIG_IGN) std::signal(signal, ask_to_stop);
}

/// "2/8": those whose number leaves 2 when divided by 8.
study::Part parse_part(const std::string& text) {
  if (text.empty()) return {};
  const std::vector<std::string_view> parts = split(text, '/');
  const auto i = parse_integer(parts[0]), n = parts.size() == 2 ? parse_integer(parts[1]) : std::nullopt;
  if (!i || !n || *i < 0 || *i >= *n)
    throw InputError(fmt::format("--shard {}: expected i/n with i from 0 to n - 1, such as 0/8", printable(text)));
  return {static_cast<std::uint64_t>(*i), static_cast<std::uint64_t>(*n)};
}

std::string spell_time(double seconds) {
  if (!std::isfinite(seconds)) return "?";
  const auto s = static_cast<long>(seconds + 0.5);
  if (s < 120) return fmt::format("{} s", s);
  if (s < 7200) return fmt::format("{} min", s / 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

std::string spell(const study::Progress& progress) {
  return fmt::format("{} of {} runs, {:.0f} %, {} left", progress.runs_done, progress.runs,
                     100.0 * static_cast<double>(progress.runs_done) / static_cast<double>(progress.runs),
                     spell_time(progress.left_s));
}

std::string fingerprint_of(const study::Plan& plan) {
  const study::ScratchFolder scratch;
  return study::fingerprint(plan, *study::make_model(plan, scratch.path()));
}

/// What was done now, and what the file holds then.
struct Outcome {
  study::CampaignSummary summary;
  study::StudyHead head;
};

Outcome play(const study::Plan& plan, const StudyOptions& options, const MakeWorkers& make_workers) {
  study::CampaignOptions campaign{.part = parse_part(options.shard)};
  campaign.stop = &stop_asked;
  study::Results results(
      plan, campaign.part, [&plan] { return fingerprint_of(plan); }, options.out);
  const ProgressLine line("study");
  campaign.progress = [&line](const study::Progress& progress) { line.show(spell(progress)); };
  const auto make = [&] { return make_workers(plan, results); };
  const study::CampaignSummary summary = run_campaign(plan, results, make, campaign);
  return {.summary = summary, .head = results.head()};
}

void print(const Outcome& outcome, const StudyOptions& options) {
  const auto& [summary, head] = outcome;
  fmt::print("{}: plan {}, {} points, {} runs in {} shards\n", head.name, head.plan_id.substr(0, 12), head.points,
             head.runs, head.shards);
  fmt::print("played {} runs in {} shards, {:.1f} s, {} workers; {} shards were there before\n", summary.runs_played,
             summary.shards_played, summary.seconds, summary.workers, summary.shards_before);
  fmt::print("{}: {} of {} shards done, {} runs failed\n", options.out, head.shards_done, head.shards,
             head.runs_failed);
  if (!summary.complete())
    fmt::print("next: the same command again goes on with the {} shards that are missing\n",
               summary.shards - summary.shards_before - summary.shards_played);
  else if (head.shards_done == head.shards)
    fmt::print("next: palpate study report {}\n", options.out);
}

void print_json(const Outcome& outcome, const StudyOptions& options) {
  const auto& [summary, head] = outcome;
  nlohmann::json json = as_json(head);
  json["file"] = options.out;
  json["workers"] = summary.workers;
  json["shards_asked"] = summary.shards;
  json["shards_before"] = summary.shards_before;
  json["shards_played"] = summary.shards_played;
  json["runs_played"] = summary.runs_played;
  json["workers_lost"] = summary.workers_lost;
  json["shards_given_up"] = summary.given_up;
  json["stopped"] = summary.stopped;
  json["complete"] = summary.complete();
  json["seconds"] = summary.seconds;
  fmt::print("{}\n", json_text(json));
}

std::vector<std::string> warnings_of(const study::CampaignSummary& summary) {
  std::vector<std::string> warnings = summary.lost;
  if (summary.workers_lost > summary.lost.size())
    warnings.push_back(fmt::format("{} more workers were lost", summary.workers_lost - summary.lost.size()));
  for (const std::uint64_t shard : summary.given_up)
    warnings.push_back(fmt::format("shard {}: given up: three workers ended while they played it", shard));
  if (summary.runs_failed > 0)
    warnings.push_back(fmt::format("{} of {} runs failed; the column failure of the export says why",
                                   summary.runs_failed, summary.runs_played));
  return warnings;
}

}  // namespace

void add_study_options(CLI::App& verb, StudyOptions& options) {
  verb.add_option("STUDY", options.study, "study file (TOML)")->type_name("FILE");
  verb.add_option("--out", options.out, "file of the results (SQLite); one of this study is gone on with")
      ->type_name("FILE");
  verb.add_option("--shard", options.shard, "only every N-th shard, the I-th of N jobs (from 0); merge joins them")
      ->type_name("I/N");
  verb.add_flag("--json", options.json, "print the summary as JSON");
}

int run_study(const StudyOptions& options, const MakeWorkers& make_workers) {
  if (options.study.empty())
    throw InputError("study: expected STUDY.toml, or one of the commands export, merge, report");
  if (options.out.empty()) throw InputError("study: --out: expected a file for the results");
  check_paths({{"STUDY", "the study", options.study}}, {{"--out", options.out}});
  parse_part(options.shard);
  stop_at(SIGINT);
  stop_at(SIGTERM);
  const study::Plan plan = study::read_study_file(options.study);
  const Outcome outcome = play(plan, options, make_workers);
  print_warnings(warnings_of(outcome.summary));
  options.json ? print_json(outcome, options) : print(outcome, options);
  return outcome.summary.complete() ? 0 : 1;
}

nlohmann::json as_json(const study::StudyHead& head) {
  return {{"name", head.name},
          {"plan_id", head.plan_id},
          {"plan", head.plan},
          {"points", head.points},
          {"runs", head.runs},
          {"runs_done", head.runs_done},
          {"runs_failed", head.runs_failed},
          {"shards", head.shards},
          {"shards_done", head.shards_done}};
}

std::string json_text(const nlohmann::json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);  // a path may be no UTF-8
}

}  // namespace palpate::app
