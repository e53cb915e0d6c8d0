// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

/// The commands of `palpate`, one file each. Each adds its subcommand; running it sets `exit_code`.
namespace palpate::app {

void add_estimate(CLI::App& app, int& exit_code);
void add_evaluate(CLI::App& app, int& exit_code);

}  // namespace palpate::app
