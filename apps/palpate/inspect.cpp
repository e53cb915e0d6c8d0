// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <palpate/session/inspection.hpp>

#include "file_paths.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

using session::CatheterSummary;
using session::SessionSummary;

struct Options {
  std::string session;
  bool full = false, json = false;
};

std::map<std::string, std::uint64_t> by_status(const CatheterSummary& catheter) {
  std::map<std::string, std::uint64_t> counts;
  for (std::size_t i = 0; i < kEstimateStatuses; ++i)
    if (catheter.statuses[i] > 0)
      counts[std::string(palpate::describe(static_cast<EstimateStatus>(i)))] = catheter.statuses[i];
  return counts;
}

nlohmann::json to_json(const CatheterSummary& catheter) {
  nlohmann::json gaps = nlohmann::json::array(), sensors = nlohmann::json::array();
  for (const RunGap& gap : catheter.gaps) gaps.push_back({{"from_s", gap.from_s}, {"to_s", gap.to_s}});
  for (std::size_t i = 0; i < catheter.usable.size(); ++i)
    sensors.push_back({{"name", catheter.catheter.sensor_names[i]}, {"frames_ok", catheter.usable[i]}});
  return {{"name", catheter.catheter.name},
          {"file", catheter.catheter.file},
          {"frames", catheter.frames},
          {"first_s", catheter.first_s},
          {"last_s", catheter.last_s},
          {"median_period_s", catheter.median_period_s},
          {"frames_by_status", by_status(catheter)},
          {"gaps", gaps},
          {"sensors", sensors}};
}

nlohmann::json to_json(const SessionSummary& summary) {
  nlohmann::json catheters = nlohmann::json::array();
  for (const CatheterSummary& catheter : summary.catheters) catheters.push_back(to_json(catheter));
  return {{"bytes", summary.bytes},
          {"log_bytes", summary.log_bytes},
          {"schema_version", summary.schema_version},
          {"program_version", summary.program_version},
          {"started", summary.started},
          {"durability", summary.durability},
          {"duration_s", summary.received_s},
          {"catheters", catheters},
          {"events", summary.events},
          {"dropped", summary.dropped},
          {"lost", summary.lost},
          {"whole", summary.whole()},
          {"damage", summary.damage}};
}

void print_catheter(const CatheterSummary& catheter) {
  fmt::print("catheter \"{}\" ({})\n", catheter.catheter.name, catheter.catheter.file);
  fmt::print("  {} frames", catheter.frames);
  if (catheter.frames > 0) fmt::print(" from {:.3f} s to {:.3f} s", catheter.first_s, catheter.last_s);
  if (catheter.median_period_s > 0.0) fmt::print(", {:.4g} Hz", 1.0 / catheter.median_period_s);
  fmt::print("\n");
  for (const auto& [status, count] : by_status(catheter)) fmt::print("  {:<14}{:>9}\n", status, count);
  for (std::size_t i = 0; i < catheter.usable.size(); ++i)
    fmt::print("  sensor {}: OK in {} frames\n", catheter.catheter.sensor_names[i], catheter.usable[i]);
  constexpr std::size_t kMostGaps = 10;
  for (std::size_t i = 0; i < std::min(catheter.gaps.size(), kMostGaps); ++i)
    fmt::print("  no frame from {:.3f} s to {:.3f} s\n", catheter.gaps[i].from_s, catheter.gaps[i].to_s);
  if (catheter.gaps.size() > kMostGaps) fmt::print("  and {} more gaps\n", catheter.gaps.size() - kMostGaps);
}

void print_text(const SessionSummary& summary, const Options& options) {
  fmt::print("{}: {:.1f} MB, schema {}, begun {} by palpate {}, durability {}, {:.1f} s\n", options.session,
             1e-6 * static_cast<double>(summary.bytes + summary.log_bytes), summary.schema_version, summary.started,
             summary.program_version, summary.durability, summary.received_s);
  if (summary.log_bytes > 0)
    fmt::print("it was not closed, or is being written: {} bytes stand in its -wal file\n", summary.log_bytes);
  for (const CatheterSummary& catheter : summary.catheters) print_catheter(catheter);
  for (const auto& [name, count] : summary.events) fmt::print("event {}: {}\n", name, count);
  if (summary.dropped > 0) fmt::print("{} records were dropped while it was recorded\n", summary.dropped);
  if (summary.whole())
    fmt::print("whole ({} check)\n", options.full ? "full" : "quick");
  else
    fmt::print("damaged: {} records that were written cannot be read\n  {}\n", summary.lost,
               fmt::join(summary.damage, "\n  "));
}

int run(const Options& options) {
  check_paths({{"SESSION", "the session", options.session}}, {});
  const SessionSummary summary = session::inspect(options.session, options.full);
  if (options.json)
    fmt::print("{}\n", to_json(summary).dump(2));
  else
    print_text(summary, options);
  return summary.whole() ? 0 : 1;
}

}  // namespace

void add_inspect(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("inspect", "What is in a recorded session, and whether it is whole");
  verb->add_option("session", options->session, "session, from palpate record or serve")->type_name("FILE")->required();
  verb->add_flag("--full", options->full, "check every index against its table as well");
  verb->add_flag("--json", options->json, "print it as JSON");
  verb->footer("Exit code 0: whole, 1: damaged, 2: no session.\nExample: palpate inspect run.palpate");
  verb->callback([options, verb, &exit_code] {
    refuse_empty_values(*verb);
    exit_code = run(*options);
  });
}

}  // namespace palpate::app
