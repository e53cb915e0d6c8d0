// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/session/reader.hpp>

namespace palpate::session {

struct ReplayOptions {
  std::string catheter;  ///< its name; empty: all of them
  /// Every frame as it was recorded, and what comes out of it now.
  std::function<void(const LiveRecord& stored, const Estimate& now)> each = {};
};

/// The first number that is not the same, in words.
struct ReplayDifference {
  std::string catheter;
  std::int64_t frame = 0;  ///< TrackerFrame::number
  double time_s = 0.0;
  std::string field, stored, now;
};

struct ReplayReport {
  std::uint64_t frames = 0;     ///< replayed
  std::uint64_t different = 0;  ///< of them those whose estimate is not the stored one to the last bit
  std::uint64_t lost = 0;       ///< of them those whose stored estimate cannot be read, so that nothing can be compared
  std::uint64_t observers = 0;  ///< made, one a catheter and one more for each event that asked for it
  std::optional<ReplayDifference> first;
  std::vector<std::string> damage;  ///< SessionReader::damage
  bool identical() const { return different == 0 && lost == 0; }
};

/// Feeds the recorded frames to new observers with the recorded settings, and compares every number that is stored of
/// an estimate, bit for bit. Throws InputError where the file is no session or a catheter's settings are not usable.
ReplayReport replay(const std::filesystem::path& path, const ReplayOptions& options = {});

/// The first field of an estimate that differs, of those that a session keeps; field, stored and now alone are set.
std::optional<ReplayDifference> first_difference(const Estimate& stored, const Estimate& now);

}  // namespace palpate::session
