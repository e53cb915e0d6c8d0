// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <palpate/session/inspection.hpp>
#include <string>
#include <vector>

namespace palpate::session {

enum class ExportFormat : std::uint8_t { kCsv, kPlusSequence, kHdf5 };

struct ExportReport {
  std::vector<std::string> files;
  std::uint64_t frames = 0;
  std::uint64_t rounded = 0;  ///< lengths of which no number of millimetres reads back as exactly the stored metres
  std::vector<std::string> warnings;
};

/// Writes a session in the formats of others, from `prefix` on; all files or none.
///   kCsv: PREFIX.tracker.csv, .estimate.csv, .events.csv, .catheter.toml, and .tendon.csv where there is one
///   kPlusSequence: PREFIX.igs.mha
///   kHdf5: PREFIX.h5, a group a catheter
/// The first two are of one catheter: with several and none named, PREFIX.NAME.* for each. Throws InputError.
ExportReport export_session(const std::filesystem::path& path, const std::string& prefix, ExportFormat format,
                            const std::string& catheter);

/// What the three have in common: the session as it is, and which of its catheters are asked for.
struct ExportSource {
  std::filesystem::path path;
  std::string prefix;
  SessionSummary summary;
  std::vector<std::size_t> chosen;  ///< indices of catheters, rising
  /// What the files of a chosen catheter begin with.
  std::string prefix_of(std::size_t catheter) const;
  /// The frame's number where these rise; else its place, for a table takes equal numbers for one frame.
  std::int64_t number_of(const LiveRecord& record, std::uint64_t place) const;
};
void export_csv(const ExportSource& source, ExportReport& report);
void export_plus_sequence(const ExportSource& source, ExportReport& report);
void export_hdf5(const ExportSource& source, ExportReport& report);

/// Millimetres that read back (times 1e-3) as exactly these metres; the nearest where there are none, and counted.
double millimetres(double metres, std::uint64_t& rounded);

}  // namespace palpate::session
