// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <palpate/math/errors.hpp>

#include "verbs.hpp"

/// Exit codes: 0 done, 1 ran and the answer is "no", 2 bad input.
int main(int argc, char** argv) {
  CLI::App app{"Palpate feels the force on a catheter's tip through its shape. Research software: not for clinical use."};
  app.name("palpate");
  app.set_version_flag("--version", "palpate " PALPATE_VERSION);
  app.require_subcommand(1);
  int exit_code = 0;
  palpate::app::add_estimate(app, exit_code);
  palpate::app::add_evaluate(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);  // --help, --version
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "palpate: %s\nRun palpate --help for the commands and their options.\n", error.what());
    return 2;
  } catch (const palpate::InputError& error) {
    std::fprintf(stderr, "palpate: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "palpate: unexpected failure: %s\n", error.what());
    return 2;
  }
  return exit_code;
}
