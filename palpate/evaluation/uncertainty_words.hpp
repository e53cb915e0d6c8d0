// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/evaluation/uncertainty_summary.hpp>
#include <palpate/observer/options.hpp>
#include <string>

namespace palpate {

/// The summary for a person, some lines: what the sigmas are made of, which direction of force and parameters one frame
/// tells least about, in how many frames something was hidden, what the scale of all forces rests on, and the region
/// that holds the last force. Empty where no frame was used.
std::string in_words(const UncertaintySummary& summary, const ObserverOptions& options);

}  // namespace palpate
