// SPDX-License-Identifier: Apache-2.0
#include "estimate_warnings.hpp"

#include <fmt/format.h>

namespace palpate::app {

void warn_of_states_without_sigma(const CatheterFile& file, std::vector<std::string>& warnings) {
  const auto warn = [&](std::string_view state, std::string_view key) {
    warnings.push_back(
        fmt::format("state {}: the catheter file states no {}, so a default is taken for it", state, key));
  };
  if (file.observer.estimate_stiffness && file.catheter.stiffness_sigma_fraction == 0.0)
    warn("stiffness", "stiffness_sigma_percent");
  if (file.observer.estimate_precurvature && file.catheter.precurvature_sigma_per_m.isZero(0.0))
    warn("precurvature", "precurvature_sigma_per_m");
}

void warn_of_few_used(const TrackerRecording& recording, std::size_t used, std::vector<std::string>& warnings) {
  if (2 * used < recording.frames.size())
    warnings.push_back(fmt::format("{}: only {} of {} frames could be used: is it of this catheter, base and sensors?",
                                   recording.source, used, recording.frames.size()));
}

}  // namespace palpate::app
