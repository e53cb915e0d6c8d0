// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/text_table.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <string_view>

namespace palpate {

/// True for a header with at least three columns of the tracker CSV beside the time.
bool looks_like_tracker_csv(std::string_view header);

/// Palpate's plain interchange, one row a sensor a frame:
/// `time_s,frame,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm,error_mm`, columns in any order, error_mm optional.
/// A sensor without a row in a frame is absent from it: not the same as a row MISSING. An OK row whose four quaternion
/// fields are all empty is a point, without orientation. Numbers that are not finite are passed on; a frame later in
/// the file with an earlier time stays where it is. Throws InputError on text that is not a number, an unknown status,
/// and rows of one frame with different times.
TrackerRecording parse_tracker_csv(const TextFile& file);

}  // namespace palpate
