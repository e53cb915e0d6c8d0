// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/registration_fit.hpp>
#include <palpate/math/errors.hpp>

namespace palpate {

void require_in_range(std::string_view field, double value, double most);

/// Throws InputError on a knob position without readings, and on fewer measured numbers than unknowns.
void require_enough_readings(const RegistrationModel& model, std::span<const KnobPosition> positions);

/// Throws InputError naming the unknown of which `information` says nothing worth having: less than 30 mm or 20 deg.
void require_all_told(const RegistrationModel& model, const RegistrationWeights& weights,
                      const Eigen::MatrixXd& information);

/// Throws InputError where the shaft as described is nowhere near the poses.
void require_near(const RegistrationModel& model, const Registration& found);

/// What a user must know of the result; `fits` from best to worst.
std::vector<std::string> registration_warnings(const RegistrationModel& model, const RegistrationWeights& weights,
                                               std::span<const RegistrationFit> fits, const Registration& found);

}  // namespace palpate
