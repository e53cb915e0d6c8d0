// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/text_table.hpp>
#include <palpate/recording/tracker_recording.hpp>

namespace palpate {

/// NDI's CSV export: a preamble that starts with `Test Date`, then `Sample:,Hour,Minutes,Seconds,ms` and seven columns
/// a sensor, `X Y Z` in mm and `qo qx qy qz`, whose names end in the sensor's. Seven zeros: the sensor was not seen.
/// Times are relative to the first row; midnight is bridged. A cut last row is read as far as its sensors are whole.
/// Throws InputError on a header of another shape, text that is no number, and a cut row elsewhere.
TrackerRecording parse_ndi_csv(const TextFile& file);

}  // namespace palpate
