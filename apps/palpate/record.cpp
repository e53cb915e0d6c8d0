// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <memory>

#include "file_paths.hpp"
#include "live_run.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

struct Options {
  std::string source, catheter, out;
  bool full = false, fast = false;
  LiveOptions live;
};

int run(const Options& options) {
  service::Settings settings;
  settings.source = "--catheter";
  settings.catheters.push_back(service::read_catheter("catheter", options.catheter));
  service::SourceSettings& source = settings.catheters.back().source = service::parse_source(options.source);
  if (options.fast) source.speed = 0.0;
  settings.link.on = settings.dashboard.on = false;
  settings.recording.path = options.out;
  if (options.full) settings.recording.options.durability = session::Durability::kFull;
  return run_live(std::move(settings), options.live);
}

}  // namespace

void add_record(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("record", "Keep every frame of a source, with its estimate, in a session file");
  verb->add_option("source", options->source,
                   "HOST:PORT of an OpenIGTLink server, a recording, a scenario (.toml), or - for standard input")
      ->type_name("SOURCE")
      ->required();
  verb->add_option("--catheter", options->catheter, "catheter file (TOML)")->type_name("FILE")->required();
  verb->add_option("--out", options->out, "session file; must not exist")->type_name("FILE")->required();
  verb->add_flag("--full", options->full, "a power cut takes nothing that was written either (synchronous FULL)");
  verb->add_flag("--fast", options->fast, "a recording or scenario as fast as it goes, not by the clock");
  verb->add_flag("--print", options->live.print, "print the forces twice a second, a line each");
  verb->add_flag("--json", options->live.json, "the health at the end as JSON");
  verb->footer(
      "Example: palpate record 127.0.0.1:18944 --catheter catheter.toml --out session.palpate\n"
      "         palpate inspect session.palpate\n"
      "         palpate replay session.palpate");
  verb->callback([options, verb, &exit_code] {
    refuse_empty_values(*verb);
    exit_code = run(*options);
  });
}

}  // namespace palpate::app
