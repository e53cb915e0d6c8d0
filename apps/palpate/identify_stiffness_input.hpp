// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/stiffness.hpp>
#include <palpate/recording/load_cases.hpp>
#include <string>
#include <vector>

namespace palpate::app {

/// What the fit needs of the catheter file and the load cases.
struct StiffnessInput {
  Catheter catheter;  ///< where there are tares: weight, precurvature and what is open of the clamp as these show
  std::vector<LoadCase> cases;
  std::vector<std::string> warnings;
};

/// Points as they are; recordings as the mean poses of their sensors, each in the base frame that its own tare shows,
/// if it has one. The sigma of a mean holds the noise over the root of the readings, the stated bias and mounting
/// error, and what the tare leaves open of the clamp. Throws InputError.
StiffnessInput load_stiffness_input(const CatheterFile& file, const LoadCaseFile& cases);

}  // namespace palpate::app
