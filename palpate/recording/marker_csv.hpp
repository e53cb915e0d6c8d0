// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/math/rotation.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Points seen by optical capture.
struct MarkerRecording {
  std::string source;
  std::vector<std::string> names;
  std::vector<double> times_s;
  std::vector<std::vector<Vector3d>> positions_m;  ///< [frame][marker]; NaN: not seen
};

/// True for a header with a column NAME_x_m or NAME_x_mm.
bool looks_like_marker_csv(std::string_view header);

/// Columns `time_s` (or `t_s`) and `NAME_x_m,NAME_y_m,NAME_z_m` (or `_mm`) a marker; other columns are ignored.
/// A blank field is a marker not seen. Throws InputError on an incomplete triple of columns and text that is no number.
MarkerRecording parse_marker_csv(const TextFile& file);

/// Makes the catheter's sensors from the markers they list, in the catheter's order, the base sensor last.
/// Position sensor: midpoint of its markers. Pose sensor: at least three markers; its origin is their centroid, its
/// axes are the base axes while the markers stand as in the mean over the reference interval, and turn with them.
/// A sensor is missing where one of its markers is. Throws InputError on an unknown marker, a collinear triad, and a
/// reference interval in which a triad is never seen whole.
TrackerRecording assemble_sensors(const MarkerRecording& markers, const RecordingOptions& options);

}  // namespace palpate
