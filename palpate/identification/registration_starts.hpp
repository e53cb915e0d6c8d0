// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/registration_model.hpp>

namespace palpate {

/// Where to start the search, best first, at most `most`: the base that one sensor's first mean pose gives for every
/// bend of a coarse grid (and, where the sensor does not tell its own roll or orientation, for every turn of one),
/// judged by how well some bend of the grid fits each knob position. Mountings as stated.
std::vector<RegistrationState> registration_starts(RegistrationModel& model, int most);

/// Points and needles see a shaft that bends about d1 as one that bends the other way about a base rolled by 180 deg.
/// Mean of k1 along the sign of the stated one (positive where that is 0) [1/m]: positive, the shaft bends as stated.
double bend_towards_stated(const RegistrationModel& model, const RegistrationState& state);
/// The base rolled by 180 deg, all bends the other way.
RegistrationState rolled_half_a_turn(const RegistrationModel& model, const RegistrationState& state);

}  // namespace palpate
