// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/service/player.hpp>
#include <palpate/service/settings.hpp>

namespace palpate::service {

/// What is played for a catheter whose source is a file, a scenario or the demonstration; all of it in memory.
/// Throws InputError where it cannot be read, or is of other sensors than the catheter's.
Reel make_reel(int index, const CatheterSettings& catheter, CatheterCounters& counters);

}  // namespace palpate::service
