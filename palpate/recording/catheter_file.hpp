// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <palpate/observer/options.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/sensing/catheter.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <span>
#include <string>
#include <vector>

namespace palpate {

/// [reference]: part of a recording in which the shaft's state is known.
struct ReferenceInterval {
  bool given = false;
  double from_s = 0.0;
  double to_s = 0.0;
  bool straight = false;  ///< held straight; otherwise unloaded, in its own precurvature
};

/// [[known_load]]: part of a recording in which the force on the tip is known, both ends included.
struct KnownLoadInterval {
  double from_s = 0.0;
  double to_s = 0.0;
  KnownLoad load;
};

/// A catheter file: one catheter in one setup, and how to estimate with it.
struct CatheterFile {
  Catheter catheter;
  ObserverOptions observer;
  std::vector<std::string> ignore_sensors;  ///< sensors of the recording that are not on this catheter
  ReferenceInterval reference;
  std::vector<KnownLoadInterval> known_loads;  ///< none overlaps another
  std::vector<std::string> warnings;           ///< what a user should know, one line each
};

/// Reads TOML as formats/catheter.toml shows it, and the keys beyond those that docs/reference/formats.md lists.
/// Throws InputError `FILE:LINE: KEY = VALUE: expected ...` on anything unknown, missing, mistyped or out of range.
CatheterFile read_catheter_file(const std::filesystem::path& path);
/// The same of a text that was read, or is to be written.
CatheterFile parse_catheter(const TextFile& text);

/// What is estimated, by the words of the catheter file and of --state: "force", to which "stiffness" and
/// "precurvature" may be added. False, and nothing chosen, where it is another list.
[[nodiscard]] bool choose_state(std::span<const std::string> names, ObserverOptions& options);

/// Sets TrackerFrame::known_load on the frames inside an interval; returns how many frames each interval holds.
std::vector<std::size_t> attach_known_loads(std::span<const KnownLoadInterval> intervals,
                                            std::span<TrackerFrame> frames);

}  // namespace palpate
