// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/tracker_recording.hpp>
#include <string>
#include <vector>

/// Several recordings of one run: other trackers or images, each with its own sensors, rate and times.
namespace palpate {

/// One recording out of several, in time order. Each source's frames keep their order and their numbers; frames of
/// exactly equal time become one (with the number of the first). In a frame the sensors of the other sources are
/// kAbsent.
///
/// Every source's times are judged by a FrameClock of its own. A frame that it rejects (not finite, standing still,
/// stepping back) stays right behind the frame before it, where the observer's clock rejects it as well: it moves no
/// frame of another source. A source whose clock was set back for good is refused, for nothing says how its new times
/// stand to the others'.
///
/// A single recording is handed back as it is. Throws InputError naming both files where a sensor occurs in two
/// recordings (of one in `ignore_sensors` the first is kept), and naming file, frame and time of a clock set back.
TrackerRecording merge_recordings(std::vector<TrackerRecording> recordings,
                                  const std::vector<std::string>& ignore_sensors = {});

/// Takes Sensor::delay_s off the times of a recording whose sensors all state the same; frames have one time, so that
/// different delays need a recording each. Sensors that the catheter lacks have no say. Throws InputError naming
/// recording, sensors and delays where they differ.
void correct_delay(TrackerRecording& recording, const Catheter& catheter);

}  // namespace palpate
