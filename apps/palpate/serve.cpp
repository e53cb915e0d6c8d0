// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <palpate/math/errors.hpp>

#include "file_paths.hpp"
#include "live_run.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

struct Options {
  std::string settings, catheter, source, record;
  bool demo = false;
  std::optional<int> link_port, dashboard_port;
  LiveOptions live;
};

std::uint16_t checked_port(const char* flag, int port) {
  if (port < 0 || port > 65535) throw InputError(fmt::format("{} {}: expected a port, 0 to 65535", flag, port));
  return static_cast<std::uint16_t>(port);
}

service::Settings read(const Options& options) {
  const bool typed = !options.catheter.empty() || !options.source.empty();
  if ((options.demo ? 1 : 0) + (typed ? 1 : 0) + (options.settings.empty() ? 0 : 1) != 1)
    throw InputError("serve: expected a settings file, or --catheter and --source, or --demo");
  if (options.demo) return service::demo_settings();
  if (!typed) return service::read_settings(options.settings);
  if (options.catheter.empty() || options.source.empty())
    throw InputError("serve: expected --catheter and --source together");
  service::Settings out;
  out.source = "--catheter";
  out.catheters.push_back(service::read_catheter("catheter", options.catheter));
  out.catheters.back().source = service::parse_source(options.source);
  return out;
}

int run(const Options& options) {
  service::Settings settings = read(options);
  if (!options.record.empty()) settings.recording.path = options.record;
  if (options.link_port) settings.link.port = checked_port("--openigtlink-port", *options.link_port);
  if (options.dashboard_port)
    settings.dashboard.server.port = checked_port("--dashboard-port", *options.dashboard_port);
  return run_live(std::move(settings), options.live);
}

}  // namespace

void add_serve(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("serve",
                                      "Live: poses in (OpenIGTLink, file, simulation, standard input); force out to a "
                                      "page in the browser, 3D Slicer and "
                                      "a recording");
  verb->add_option("settings", options->settings, "settings file (TOML): catheters, sources, ports, recording")
      ->type_name("FILE");
  verb->add_flag("--demo", options->demo, "a virtual catheter before a beating heart: needs nothing else");
  verb->add_option("--catheter", options->catheter, "catheter file (TOML), in place of a settings file")
      ->type_name("FILE");
  verb->add_option("--source", options->source,
                   "HOST:PORT of an OpenIGTLink server (PLUS: 127.0.0.1:18944), ndi:/dev/ttyUSB0 of an NDI Aurora, a "
                   "recording, a scenario (.toml), or - for tracker CSV on standard input")
      ->type_name("SOURCE");
  verb->add_option("--record", options->record, "session file to record into; must not exist")->type_name("FILE");
  verb->add_option("--openigtlink-port", options->link_port, "where 3D Slicer connects; 0: any free one")
      ->type_name("PORT");
  verb->add_option("--dashboard-port", options->dashboard_port,
                   "of the page in the browser and of the control interface; 0: any free one")
      ->type_name("PORT");
  verb->add_option("--for", options->live.for_s, "seconds after which it ends by itself")->check(CLI::Range(0.1, 1e7));
  verb->add_flag("--print", options->live.print, "print the forces twice a second, a line each");
  verb->add_flag("--json", options->live.json,
                 "ports, address and token at the start and health at the end as JSON, one line each");
  verb->footer(
      "Example: palpate serve --demo\n"
      "         palpate serve --catheter catheter.toml --source 127.0.0.1:18944 --record session.palpate\n"
      "         palpate serve laboratory.toml");
  verb->callback([options, verb, &exit_code] {
    refuse_empty_values(*verb);
    exit_code = run(*options);
  });
}

}  // namespace palpate::app
