// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <string>
#include <vector>

namespace palpate::app {

/// What is estimated starts from the catheter file's value and sigma; the observer has a default for the sigma alone.
void warn_of_states_without_sigma(const CatheterFile& file, std::vector<std::string>& warnings);

/// A recording of which less than half could be used is rarely that of the catheter.
void warn_of_few_used(const TrackerRecording& recording, std::size_t used, std::vector<std::string>& warnings);

}  // namespace palpate::app
