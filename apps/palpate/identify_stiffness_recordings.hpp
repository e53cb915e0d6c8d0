// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "identify_stiffness_input.hpp"

namespace palpate::app {

/// Fills the cases of `input` that are in recordings with the mean poses of their sensors, in the base frame that the
/// case's tare shows, if it has one; input.catheter gets weight, precurvature and clamp covariance as the tares show
/// them. Throws InputError.
void load_recorded_cases(const CatheterFile& file, const LoadCaseFile& cases, StiffnessInput& input);

}  // namespace palpate::app
