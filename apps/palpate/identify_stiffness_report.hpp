// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/stiffness.hpp>
#include <string>
#include <vector>

#include "identify_stiffness_toml.hpp"

namespace palpate::app {

/// All that `palpate identify stiffness` tells of a fit.
struct StiffnessReport {
  std::string catheter, cases, out;  ///< paths as given
  StiffnessOptions options;
  StiffnessFit fit;
  std::vector<LoadCase> load_cases;
  std::vector<LeftOut> left_out;  ///< empty: not done
  CommonSigma sigma;
  std::vector<std::string> warnings;
};

/// For a person, and for a program.
void print_text(const StiffnessReport& report);
void print_json(const StiffnessReport& report);

}  // namespace palpate::app
