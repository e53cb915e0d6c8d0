// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <palpate/evaluation/uncertainty_summary.hpp>
#include <palpate/observer/options.hpp>

namespace palpate::app {

/// Adds to the summary for a program what its sigmas are made of, what they rest on and what could not be observed.
void add_uncertainty(const UncertaintySummary& summary, const ObserverOptions& options, nlohmann::json& json);

}  // namespace palpate::app
