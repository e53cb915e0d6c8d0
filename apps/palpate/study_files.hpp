// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {
class App;
}

namespace palpate::app {

/// palpate study export | merge | report
void add_study_files(CLI::App& study, int& exit_code);

}  // namespace palpate::app
