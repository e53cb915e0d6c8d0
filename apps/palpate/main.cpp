// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <palpate/math/errors.hpp>
#include <string>

#include "usage_error.hpp"
#include "verbs.hpp"

namespace {

/// One line that says what is wrong, one where to read on.
int refuse_usage(const CLI::App& app, const CLI::ParseError& error, std::span<const char* const> arguments) {
  fmt::print(stderr, "palpate: {}\n", palpate::app::explain_unknown_word(app, arguments).value_or(error.what()));
  std::string command = "palpate";
  for (auto verbs = app.get_subcommands(); !verbs.empty(); verbs = verbs[0]->get_subcommands())
    command += " " + verbs[0]->get_name();
  fmt::print(stderr, "Run {} --help for what is possible.\n", command);
  return 2;
}

}  // namespace

/// Exit codes: 0 done, 1 ran and the answer is "no", 2 bad input.
int main(int argc, char** argv) {
  CLI::App app{
      "Palpate feels the force on a catheter's tip through its shape. Research software: not for clinical use."};
  app.name("palpate");
  app.set_version_flag("--version", "palpate " PALPATE_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Example: palpate estimate --catheter catheter.toml run.tracker.csv --out run.estimate.csv\n"
      "Each command has its own --help.");
  int exit_code = 0;
  palpate::app::add_estimate(app, exit_code);
  palpate::app::add_evaluate(app, exit_code);
  palpate::app::add_export(app, exit_code);
  palpate::app::add_identify(app, exit_code);
  palpate::app::add_inspect(app, exit_code);
  palpate::app::add_record(app, exit_code);
  palpate::app::add_replay(app, exit_code);
  palpate::app::add_report(app, exit_code);
  palpate::app::add_reproduce(app, exit_code);
  palpate::app::add_serve(app, exit_code);
  palpate::app::add_simulate(app, exit_code);
  palpate::app::add_study(app, exit_code);
  palpate::app::add_completion(app, exit_code);
  palpate::app::add_man(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);  // --help, --version
  } catch (const CLI::ParseError& error) {
    return refuse_usage(app, error, {argv + 1, argv + argc});
  } catch (const palpate::InputError& error) {
    fmt::print(stderr, "palpate: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "palpate: unexpected failure: {}\n", error.what());
    return 2;
  }
  return exit_code;
}
