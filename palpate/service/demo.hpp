// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/simulation/scenario.hpp>

namespace palpate::service {

/// What happens to the catheter of demo_settings(): a beating, breathing wall comes, stays and goes, within a minute.
Scenario demo_scenario(const Catheter& catheter);

}  // namespace palpate::service
