// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/catheter_file.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace palpate::app {

/// The command line of `palpate estimate`, as typed; empty: not given.
struct EstimateOptions {
  std::vector<std::string> recordings;  ///< of one run, each with its own sensors
  std::string catheter, out, tendon, method, state, measurement, force_model, reference, average, plot, budget;
  double forecast_s = 0.0;  ///< 0: none
  bool smooth = false, strict = false, json = false, no_consider = false;
};

void add_estimate_options(CLI::App& verb, EstimateOptions& options);

/// Throws InputError on what can be told before any file is read: an empty name, a picture of
/// unknown kind, an output over an input or in a folder that is not there.
void check_paths(const EstimateOptions& options);

/// Puts what was typed in place of what the catheter file says. Throws InputError naming flag, value and expectation.
void apply_options(const EstimateOptions& options, CatheterFile& file);

std::string_view name_of(Method method);
std::string_view name_of(MeasurementKind kind);
std::string_view name_of(ForceMotion motion);

}  // namespace palpate::app
