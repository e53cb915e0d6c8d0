// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/session/live_record.hpp>

namespace palpate::session {

/// All that a tare or a new registration may change of a catheter, every number with all its digits: the base with its
/// sigmas, the precurvature of each section with its sigma, the own weight's direction.
nlohmann::json catheter_change(const Catheter& catheter);

/// Makes `catheter` as catheter_change() has it. Throws InputError where it is of another catheter, or no such thing.
void apply_catheter_change(const nlohmann::json& change, Catheter& catheter);

/// An event of a session upon the settings it began with: true where the observer has to be made anew, as it was then.
/// Throws InputError where its data cannot be read.
bool apply_event(const LiveRecord& event, CatheterFile& settings);

}  // namespace palpate::session
