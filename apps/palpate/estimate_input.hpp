// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/observer/estimate.hpp>
#include <palpate/recording/tracker_recording.hpp>

#include "estimate_options.hpp"

namespace palpate::app {

/// The recording, or several merged by time, in the order of the catheter's sensors, with the tendon's moment and
/// known loads in its frames, checked for what would make the whole run meaningless. Adds to `warnings` what a user
/// should know. Throws InputError.
TrackerRecording load_recording(const EstimateOptions& options, const CatheterFile& file,
                                std::vector<std::string>& warnings);
/// The same of recordings that were read already.
TrackerRecording prepare_recording(std::vector<TrackerRecording> sources, const EstimateOptions& options,
                                   const CatheterFile& file, std::vector<std::string>& warnings);

/// --strict: throws InputError on rows of the recording that are passed over,
void refuse_passed_over_rows(const TrackerRecording& recording);
/// and on a frame whose time or readings are. A sensor that the tracker itself reports as MISSING is none, nor is one
/// that is not in the frame; nor is a frame held for want of it.
void refuse_passed_over_readings(const TrackerRecording& recording, const TrackerFrame& frame,
                                 const Estimate& estimate);

}  // namespace palpate::app
