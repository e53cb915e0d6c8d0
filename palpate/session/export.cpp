// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>
#include <palpate/session/estimate_numbers.hpp>
#include <palpate/session/export.hpp>
#include <palpate/session/session_run_reader.hpp>

namespace palpate::session {

namespace {

/// A name as part of a file's name.
std::string file_word(const std::string& name) {
  std::string word;
  for (const char c : name) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-';
    if (plain || (!word.empty() && word.back() != '_')) word += plain ? c : '_';
  }
  return word;
}

std::vector<std::size_t> choose(const std::filesystem::path& path, const std::string& catheter, std::size_t count) {
  if (!catheter.empty()) return {find_catheter(SessionReader(path), path.string(), catheter)};
  std::vector<std::size_t> all(count);
  for (std::size_t i = 0; i < count; ++i) all[i] = i;
  return all;
}

}  // namespace

std::string ExportSource::prefix_of(std::size_t catheter) const {
  if (chosen.size() == 1) return prefix;
  const std::string word = file_word(summary.catheters[catheter].catheter.name);
  for (const std::size_t other : chosen)
    if (other != catheter && file_word(summary.catheters[other].catheter.name) == word)
      return fmt::format("{}.{}-{}", prefix, word, catheter);
  return fmt::format("{}.{}", prefix, word);
}

std::int64_t ExportSource::number_of(const LiveRecord& record, std::uint64_t place) const {
  const bool rise = summary.catheters[static_cast<std::size_t>(record.catheter)].numbers_rise;
  return rise ? record.frame.number : static_cast<std::int64_t>(place);
}

double millimetres(double metres, std::uint64_t& rounded) {
  const double nearest = metres * kMillimetresPerMetre;
  if (!std::isfinite(metres)) return nearest;
  double below = nearest, above = nearest;
  for (int i = 0; i < 3; ++i) {
    if (same_number(below * kMetresPerMillimetre, metres)) return below;
    if (same_number(above * kMetresPerMillimetre, metres)) return above;
    below = std::nextafter(below, -HUGE_VAL);
    above = std::nextafter(above, HUGE_VAL);
  }
  ++rounded;
  return nearest;
}

ExportReport export_session(const std::filesystem::path& path, const std::string& prefix, ExportFormat format,
                            const std::string& catheter) {
  ExportSource source{.path = path, .prefix = prefix, .summary = inspect(path), .chosen = {}};
  if (source.summary.catheters.empty())
    throw InputError(fmt::format("{}: expected at least one catheter, found none that can be read", path.string()));
  source.chosen = choose(path, catheter, source.summary.catheters.size());
  ExportReport report;
  report.warnings = source.summary.damage;
  if (format == ExportFormat::kCsv) export_csv(source, report);
  if (format == ExportFormat::kPlusSequence) export_plus_sequence(source, report);
  if (format == ExportFormat::kHdf5) export_hdf5(source, report);
  for (const std::size_t i : source.chosen) {
    const CatheterSummary& summary = source.summary.catheters[i];
    const std::string& name = summary.catheter.name;
    if (format != ExportFormat::kHdf5 && !summary.numbers_rise)
      report.warnings.push_back(
          fmt::format("{}: its frame numbers do not rise; frames are numbered as they were recorded", name));
    if (format == ExportFormat::kCsv && summary.frames_without_rows > 0)
      report.warnings.push_back(fmt::format("{}: {} frames speak of no sensor and have no row in a tracker CSV", name,
                                            summary.frames_without_rows));
  }
  return report;
}

}  // namespace palpate::session
