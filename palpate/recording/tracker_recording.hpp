// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <palpate/sensing/catheter.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <string>
#include <vector>

namespace palpate {

/// What a file of any format holds, in file order. Times and poses are as received: the observer judges them.
struct TrackerRecording {
  std::string source;                       ///< the path as given; of merged recordings all, ", " between them
  std::vector<std::string> sensor_names;    ///< order of the readings in every frame
  std::vector<std::size_t> sensor_lines;    ///< line where each sensor first occurs; 0: not known
  std::vector<std::string> sensor_sources;  ///< merged: the path in which each sensor stands; otherwise empty
  std::vector<TrackerFrame> frames;         ///< a sensor of which a frame does not speak is kAbsent in it
  std::size_t duplicate_rows = 0;           ///< further rows of the same frame and sensor; the first was kept
  std::string first_duplicate;              ///< which that is, in words; empty without one
  std::string first_duplicate_source;       ///< merged: the path in which it stands; otherwise empty
  std::vector<std::string> notes;           ///< one line each: what a user should know about the file
};

/// What a marker file needs to become sensor poses; other formats need none of it.
struct RecordingOptions {
  const Catheter* catheter = nullptr;  ///< whose sensors list `markers`
  double reference_from_s = 0.0;       ///< interval in which a triad is as the unloaded (or straight) shaft holds it
  double reference_to_s = 0.0;
  bool reference_straight = false;  ///< the shaft is held straight there; otherwise its own bend and weight act
  bool one_of_several = false;      ///< a sensor without `markers` stands in another recording: no error
};

/// Recognises the format by name and content and reads it: tracker CSV, PLUS sequence (.mha), NDI CSV, marker CSV, MR
/// coil text (a file or its folder). Throws InputError naming file, line, field, value and expectation.
TrackerRecording read_tracker_recording(const std::filesystem::path& path, const RecordingOptions& options = {});

/// The path in which the frame stands (of a joined frame: the first of them); `source` where it was not merged.
const std::string& source_of(const TrackerRecording& recording, const TrackerFrame& frame);

/// Brings every frame's readings into the order of `catheter.sensors`, the base sensor (if tracked) last.
/// Throws InputError on a sensor of the recording that the catheter lacks, unless it is in `ignore_sensors`, and on a
/// sensor of the catheter that never occurs in the recording.
void bind_to_catheter(TrackerRecording& recording, const Catheter& catheter,
                      const std::vector<std::string>& ignore_sensors = {});

}  // namespace palpate
