// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "verbs.hpp"

namespace palpate::app {

void add_identify(CLI::App& app, int& exit_code) {
  CLI::App* verb = app.add_subcommand("identify", "Find a catheter's numbers from measurements, one command a number");
  verb->require_subcommand(1);
  verb->footer(
      "Example: palpate identify noise --catheter catheter.toml rest.tracker.csv --out identified.toml\n"
      "Each command has its own --help.");
  add_identify_stiffness(*verb, exit_code);
  add_identify_precurvature(*verb, exit_code);
  add_identify_registration(*verb, exit_code);
  add_identify_noise(*verb, exit_code);
  add_identify_delay(*verb, exit_code);
}

}  // namespace palpate::app
