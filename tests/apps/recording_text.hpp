// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <palpate/math/pose.hpp>
#include <string>
#include <vector>

namespace palpate::test {

/// A tracker CSV that can be spoilt row by row.
struct RecordingText {
  enum Column { kTime, kFrame, kSensor, kStatus, kQ0, kQx, kQy, kQz, kX, kY, kZ, kError };
  using Row = std::array<std::string, 12>;

  std::vector<Row> rows;

  static RecordingText parse(const std::string& csv);
  std::string text() const;
  /// The sensor's row of the frame; throws where there is none.
  Row& at(int frame, const std::string& sensor);
  /// Both rows of the frame.
  std::vector<Row*> frame(int number);

  static void set_missing(Row& row);
  static void set_pose(Row& row, const std::array<const char*, 7>& values);
};

/// A clean recording of the demo's catheter: two sensors, 40 Hz, no reading missing or wrong.
struct CleanRecording {
  std::string catheter;  ///< TOML
  RecordingText tracker;
  std::vector<Vector3d> force_tip_N;  ///< truth, one a frame
};

/// 4 s against the beating wall; made once.
const CleanRecording& beating_recording();
/// 4 s, the first 2 s without force, the clamp 2 mm and 1 deg from where the catheter file has it (within its sigmas).
const CleanRecording& shifted_recording();
/// As the first, of any length; not kept.
CleanRecording make_recording(double duration_s);

}  // namespace palpate::test
