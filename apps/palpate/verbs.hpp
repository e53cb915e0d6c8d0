// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

/// The commands of `palpate`, one file each. Each adds its subcommand; running it sets `exit_code`.
namespace palpate::app {

void add_estimate(CLI::App& app, int& exit_code);
void add_evaluate(CLI::App& app, int& exit_code);
void add_export(CLI::App& app, int& exit_code);
void add_identify(CLI::App& app, int& exit_code);
void add_inspect(CLI::App& app, int& exit_code);
void add_record(CLI::App& app, int& exit_code);
void add_replay(CLI::App& app, int& exit_code);
void add_report(CLI::App& app, int& exit_code);
void add_reproduce(CLI::App& app, int& exit_code);
void add_serve(CLI::App& app, int& exit_code);
void add_simulate(CLI::App& app, int& exit_code);
void add_study(CLI::App& app, int& exit_code);

/// Not shown by --help: what a package brings to shell and manual, made of the commands added before.
void add_completion(CLI::App& app, int& exit_code);
void add_man(CLI::App& app, int& exit_code);

// palpate identify ...
void add_identify_stiffness(CLI::App& identify, int& exit_code);
void add_identify_precurvature(CLI::App& identify, int& exit_code);
void add_identify_registration(CLI::App& identify, int& exit_code);
void add_identify_noise(CLI::App& identify, int& exit_code);
void add_identify_delay(CLI::App& identify, int& exit_code);

}  // namespace palpate::app
