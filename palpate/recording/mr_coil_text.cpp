// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <map>
#include <palpate/math/errors.hpp>
#include <palpate/recording/frame_assembler.hpp>
#include <palpate/recording/mr_coil_text.hpp>
#include <palpate/recording/text_table.hpp>
#include <regex>
#include <system_error>

namespace palpate {
namespace {

constexpr std::array<const char*, 7> kColumns = {"X", "Y", "Z", "SNR", "time", "trigger", "respiration"};
constexpr double kMostMilliseconds = 9e15;  // integers beyond are not exact in a double

struct CoilName {
  std::int64_t coil = 0;
  std::string recording;
};

std::optional<CoilName> parse_name(const std::filesystem::path& path) {
  static const std::regex kPattern("cathcoords-coil([0-9]{1,9})-(.+)\\.txt");
  const std::string name = path.filename().string();
  std::smatch match;
  if (!std::regex_match(name, match, kPattern)) return std::nullopt;
  return CoilName{std::stoll(match[1].str()), match[2].str()};
}

/// Coil files of a folder, by recording and coil.
std::map<std::string, std::map<std::int64_t, std::filesystem::path>> list_coils(const std::filesystem::path& folder) {
  std::map<std::string, std::map<std::int64_t, std::filesystem::path>> recordings;
  std::error_code error;
  const std::filesystem::directory_iterator entries(folder, error);
  if (error) throw InputError(fmt::format("{}: cannot be read: {}", folder.string(), error.message()));
  for (const auto& entry : entries) {
    if (const auto name = parse_name(entry.path())) recordings[name->recording][name->coil] = entry.path();
  }
  return recordings;
}

std::string only_recording(const std::filesystem::path& folder) {
  const auto recordings = list_coils(folder);
  if (recordings.size() == 1) return recordings.begin()->first;
  if (recordings.empty()) {
    throw InputError(fmt::format(
        "{}: is a folder: expected the file of a recording, or MR coil text named cathcoords-coil<K>-<REC>.txt in it",
        folder.string()));
  }
  std::vector<std::string> names;
  names.reserve(recordings.size());
  for (const auto& [name, coils] : recordings) names.push_back(name);
  throw InputError(fmt::format("{}: holds the recordings {}: expected one; name a file of the one you mean, such as {}",
                               folder.string(), fmt::join(names, ", "),
                               recordings.begin()->second.begin()->second.string()));
}

struct CoilSample {
  SensorReading reading;
  std::size_t sensor = 0;
};

using SamplesByTime = std::multimap<std::int64_t, CoilSample>;

std::array<double, kColumns.size()> parse_line(const TextFile& file, std::size_t line) {
  const auto texts = split_blank(file.lines[line - 1]);
  if (texts.size() != kColumns.size()) {
    const bool cut = texts.size() < kColumns.size() && line == file.lines.size() && !file.ends_with_newline;
    refuse_field(file.name, line, "row", file.lines[line - 1],
                 fmt::format("7 numbers, found {}{}", texts.size(), cut ? " (truncated last row)" : ""));
  }
  std::array<double, kColumns.size()> values{};
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const auto value = parse_number(texts[i]);
    if (!value) refuse_field(file.name, line, kColumns[i], texts[i], "a number");
    values[i] = *value;
  }
  if (!(std::abs(values[4]) < kMostMilliseconds)) {
    refuse_field(file.name, line, kColumns[4], texts[4], "a time in milliseconds since the epoch");
  }
  return values;
}

void read_coil(const std::filesystem::path& path, std::size_t sensor, SamplesByTime& samples) {
  const TextFile file = read_text_file(path);
  for (std::size_t line = 1; line <= file.lines.size(); ++line) {
    if (trim(file.lines[line - 1]).empty()) continue;
    const auto values = parse_line(file, line);
    CoilSample sample;
    sample.sensor = sensor;
    sample.reading.status = SensorReading::Status::kOk;
    sample.reading.position_m = position_from_millimetres(values[0], values[1], values[2]);
    samples.emplace(std::llround(values[4]), sample);
  }
}

}  // namespace

bool is_mr_coil_name(const std::filesystem::path& path) { return parse_name(path).has_value(); }

TrackerRecording read_mr_coil_text(const std::filesystem::path& path) {
  const auto name = parse_name(path);
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);
  if (name && !is_folder) read_text_file(path);  // tells why, where it cannot be read
  if (!name && !is_folder) throw InputError(path.string() + ": expected the name cathcoords-coil<K>-<REC>.txt");
  const std::filesystem::path folder = is_folder ? path : path.has_parent_path() ? path.parent_path() : ".";
  const std::string recording = is_folder ? only_recording(folder) : name->recording;

  FrameAssembler assembler(path.string(), SensorReading::Status::kAbsent);
  SamplesByTime samples;
  const auto recordings = list_coils(folder);
  for (const auto& [coil, file] : recordings.at(recording)) {
    read_coil(file, assembler.sensor(fmt::format("coil{}", coil), 0), samples);
  }
  const std::int64_t start_ms = samples.begin()->first;
  std::int64_t number = -1;
  std::int64_t last_ms = 0;
  for (const auto& [time_ms, sample] : samples) {
    if (number < 0 || time_ms != last_ms) ++number;
    last_ms = time_ms;
    const double time_s = 1e-3 * static_cast<double>(time_ms - start_ms);
    assembler.put(assembler.frame(number, time_s), sample.sensor, sample.reading);
  }
  return assembler.finish();
}

}  // namespace palpate
