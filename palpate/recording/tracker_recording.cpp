// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <palpate/math/errors.hpp>
#include <palpate/recording/marker_csv.hpp>
#include <palpate/recording/mr_coil_text.hpp>
#include <palpate/recording/ndi_csv.hpp>
#include <palpate/recording/plus_sequence.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/recording/tracker_csv.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <system_error>

namespace palpate {
namespace {

constexpr std::string_view kFormats =
    "tracker CSV (time_s,frame,sensor,status,q0,...), a PLUS sequence (.igs.mha), NDI CSV (first line 'Test Date'), "
    "marker CSV (time_s,NAME_x_m,NAME_y_m,NAME_z_m,... or _mm), or MR coil text (cathcoords-coil<K>-<REC>.txt or its "
    "folder)";

std::vector<std::string> expected_names(const Catheter& catheter) {
  std::vector<std::string> names;
  for (const Sensor& sensor : catheter.sensors) names.push_back(sensor.name);
  if (catheter.base.tracked) names.push_back(catheter.base.sensor.name);
  return names;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void refuse_strangers(const TrackerRecording& recording, const std::vector<std::string>& expected,
                      const std::vector<std::string>& ignored) {
  for (std::size_t i = 0; i < recording.sensor_names.size(); ++i) {
    const std::string& name = recording.sensor_names[i];
    if (contains(expected, name) || contains(ignored, name)) continue;
    const std::size_t line = i < recording.sensor_lines.size() ? recording.sensor_lines[i] : 0;
    const std::string& source = recording.sensor_sources.empty() ? recording.source : recording.sensor_sources[i];
    const std::string place = line > 0 ? fmt::format("{}:{}", source, line) : source;
    throw InputError(
        fmt::format("{}: field sensor: value '{}': expected a sensor of the catheter ({}), or [recording] "
                    "ignore_sensors of the catheter file to name it",
                    place, printable(name), fmt::join(expected, ", ")));
  }
}

}  // namespace

TrackerRecording read_tracker_recording(const std::filesystem::path& path, const RecordingOptions& options) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored) || is_mr_coil_name(path)) return read_mr_coil_text(path);
  if (path.extension() == ".mha") return read_plus_sequence(path);
  const TextFile file = read_text_file(path, "ElementDataFile");
  const std::size_t header = static_cast<std::size_t>(
      std::find_if(file.lines.begin(), file.lines.end(), [](const auto& line) { return !trim(line).empty(); }) -
      file.lines.begin());
  const std::string& first = file.lines[header];
  if (first.starts_with("ObjectType")) return parse_plus_sequence(file);
  if (first.starts_with("Test Date")) return parse_ndi_csv(file);
  if (looks_like_tracker_csv(first)) return parse_tracker_csv(file);
  if (looks_like_marker_csv(first)) return assemble_sensors(parse_marker_csv(file), options);
  refuse_field(file.name, header + 1, "header", first, kFormats);
}

const std::string& source_of(const TrackerRecording& recording, const TrackerFrame& frame) {
  for (std::size_t i = 0; i < recording.sensor_sources.size(); ++i)
    if (frame.readings[i].status != SensorReading::Status::kAbsent) return recording.sensor_sources[i];
  return recording.source;
}

void bind_to_catheter(TrackerRecording& recording, const Catheter& catheter,
                      const std::vector<std::string>& ignore_sensors) {
  const std::vector<std::string> expected = expected_names(catheter);
  refuse_strangers(recording, expected, ignore_sensors);
  std::vector<std::size_t> from;
  for (const std::string& name : expected) {
    const auto found = std::find(recording.sensor_names.begin(), recording.sensor_names.end(), name);
    if (found == recording.sensor_names.end()) {
      throw InputError(
          fmt::format("{}: field sensor: value '{}': expected this sensor of the catheter to occur; the "
                      "recording has {}",
                      recording.source, printable(name), fmt::join(recording.sensor_names, ", ")));
    }
    from.push_back(static_cast<std::size_t>(found - recording.sensor_names.begin()));
  }
  for (TrackerFrame& frame : recording.frames) {
    std::vector<SensorReading> ordered;
    ordered.reserve(from.size());
    for (const std::size_t i : from) ordered.push_back(frame.readings[i]);
    frame.readings = std::move(ordered);
  }
  recording.sensor_lines.resize(recording.sensor_names.size(), 0);
  std::vector<std::size_t> lines;
  lines.reserve(from.size());
  for (const std::size_t i : from) lines.push_back(recording.sensor_lines[i]);
  recording.sensor_lines = std::move(lines);
  if (!recording.sensor_sources.empty()) {
    std::vector<std::string> sources;
    sources.reserve(from.size());
    for (const std::size_t i : from) sources.push_back(recording.sensor_sources[i]);
    recording.sensor_sources = std::move(sources);
  }
  recording.sensor_names = expected;
}

}  // namespace palpate
