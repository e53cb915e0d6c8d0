// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <palpate/math/errors.hpp>
#include <palpate/recording/estimate_csv.hpp>
#include <palpate/session/replay.hpp>
#include <palpate/session/session_run_reader.hpp>

#include "file_paths.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

struct Options {
  std::string session, out, catheter;
  bool json = false;
};

nlohmann::json to_json(const session::ReplayReport& report) {
  nlohmann::json out{{"frames", report.frames},         {"different", report.different}, {"lost", report.lost},
                     {"identical", report.identical()}, {"observers", report.observers}, {"damage", report.damage}};
  if (report.first)
    out["first_difference"] = {{"catheter", report.first->catheter}, {"frame", report.first->frame},
                               {"time_s", report.first->time_s},     {"field", report.first->field},
                               {"stored", report.first->stored},     {"now", report.first->now}};
  return out;
}

void print_text(const session::ReplayReport& report, const Options& options) {
  if (report.lost > 0) fmt::print("of {} frames the stored estimate cannot be read\n", report.lost);
  if (report.identical())
    fmt::print("{} frames replayed: every stored estimate is identical to the last bit\n", report.frames);
  else if (report.first)
    fmt::print("{} of {} frames are not identical\nfirst: catheter \"{}\", frame {} at {} s: {}: stored {}, now {}\n",
               report.different, report.frames, report.first->catheter, report.first->frame, report.first->time_s,
               report.first->field, report.first->stored, report.first->now);
  if (!options.out.empty()) fmt::print("wrote {}\n", options.out);
}

/// The columns of --out are those of its one catheter.
std::unique_ptr<EstimateCsvWriter> open_out(const Options& options) {
  if (options.out.empty()) return nullptr;
  const session::SessionReader reader(options.session);
  const std::size_t catheter = session::find_catheter(reader, options.session, options.catheter);
  const ObserverOptions observer = session::settings_of(reader.catheters()[catheter]).observer;
  return std::make_unique<EstimateCsvWriter>(options.out, EstimateColumns::of(observer));
}

int run(const Options& options) {
  check_paths({{"SESSION", "the session", options.session}}, {{"--out", options.out}});
  const auto out = open_out(options);
  session::ReplayOptions replay{.catheter = options.catheter};
  if (out) replay.each = [&](const session::LiveRecord&, const Estimate& now) { out->write(now); };
  const session::ReplayReport report = session::replay(options.session, replay);
  if (out) out->commit();
  print_warnings(report.damage);
  if (options.json)
    fmt::print("{}\n", to_json(report).dump(2));
  else
    print_text(report, options);
  return report.identical() ? 0 : 1;
}

}  // namespace

void add_replay(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("replay", "Estimate a recorded session again: identical to the last bit?");
  verb->add_option("session", options->session, "session, from palpate record or serve")->type_name("FILE")->required();
  verb->add_option("--out", options->out, "estimate CSV of what comes out now, of one catheter")->type_name("FILE");
  verb->add_option("--catheter", options->catheter, "one catheter of several, by its name")->type_name("NAME");
  verb->add_flag("--json", options->json, "print the verdict as JSON");
  verb->footer("Exit code 0: identical, 1: not.\nExample: palpate replay run.palpate --out again.estimate.csv");
  verb->callback([options, verb, &exit_code] {
    refuse_empty_values(*verb);
    exit_code = run(*options);
  });
}

}  // namespace palpate::app
