// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <palpate/identification/tare.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <string>
#include <vector>

namespace palpate::app {

struct CorrectedCatheter {
  Catheter catheter;
  std::optional<Tare> tare;  ///< none where the file has no [reference]
};

/// The catheter as the reference interval shows it, where there is one; driven by its tendon map where the frames carry
/// the handle's bend. Adds to `warnings` what makes the interval doubtful.
CorrectedCatheter correct_by_reference(const CatheterFile& file, const TrackerRecording& recording,
                                       std::vector<std::string>& warnings);

}  // namespace palpate::app
