// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/precurvature.hpp>
#include <palpate/identification/tendon_map.hpp>
#include <palpate/recording/handle_csv.hpp>
#include <palpate/recording/tracker_recording.hpp>

namespace palpate::app {

/// A stretch of the recording in which the handle stood still.
struct HandleStretch {
  double from_s = 0.0, to_s = 0.0, position = 0.0;
  bool release = false;
  int frames = 0;
  ArcFit arc;
};

/// Stretches of `rest_s` or longer in which the handle moves by less than a hundredth of its range; the first fifth of
/// each, at most 0.3 s, is left for the shaft to settle. One arc each. A stretch is of the release branch where the
/// handle's last movement before it was backwards. Throws InputError where there are none with usable frames.
std::vector<HandleStretch> find_stretches(const Catheter& catheter, const TrackerRecording& recording,
                                          const HandleTrace& handle, double rest_s, ClampKnowledge clamp);

std::vector<HandleSample> samples_of(const std::vector<HandleStretch>& stretches);

}  // namespace palpate::app
