// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <palpate/recording/run_reader.hpp>
#include <palpate/session/reader.hpp>

namespace palpate::session {

/// What one catheter of a session has.
struct CatheterSummary {
  SessionCatheter catheter;
  std::uint64_t frames = 0;
  double first_s = 0.0, last_s = 0.0;  ///< device time of its first and last frame
  double median_period_s = 0.0;        ///< NaN below two frames
  std::vector<RunGap> gaps;            ///< device time
  std::array<std::uint64_t, kEstimateStatuses> statuses{};
  std::vector<std::uint64_t> usable;  ///< readings of each sensor with status OK
  bool numbers_rise = true;           ///< each frame's number is above the one before
  std::uint64_t frames_without_rows = 0;
  bool has_tendon = false;
};

/// What is in a session, and whether it is whole.
struct SessionSummary {
  std::uintmax_t bytes = 0, log_bytes = 0;  ///< log: what a session that was not closed has beside it
  std::int64_t schema_version = 0;
  std::string program_version, started, durability;
  std::vector<CatheterSummary> catheters;
  std::map<std::string, std::uint64_t> events;  ///< by name
  std::uint64_t dropped = 0;                    ///< records that found no room while it was recorded
  std::int64_t lost = 0;                        ///< frames and events that were written and cannot be read
  double received_s = 0.0;                      ///< host time from the first to the last record
  std::vector<std::string> damage;
  bool whole() const { return damage.empty(); }
};

/// Reads all of it. `full`: SQLite's whole check beside the quick one. Throws InputError where the file is no session.
SessionSummary inspect(const std::filesystem::path& path, bool full = false);

}  // namespace palpate::session
