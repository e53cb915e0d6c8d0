// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <palpate/math/units.hpp>
#include <palpate/recording/frame_assembler.hpp>
#include <palpate/recording/tracker_csv.hpp>

namespace palpate {
namespace {

constexpr std::array<std::string_view, 7> kPoseColumns = {"q0", "qx", "qy", "qz", "tx_mm", "ty_mm", "tz_mm"};
constexpr std::array<std::string_view, 3> kRowColumns = {"frame", "sensor", "status"};

struct Columns {
  explicit Columns(const CsvReader& csv)
      : time(csv.require("time_s")),
        frame(csv.require("frame")),
        sensor(csv.require("sensor")),
        status(csv.require("status")),
        error(csv.find("error_mm")) {
    std::transform(kPoseColumns.begin(), kPoseColumns.end(), pose.begin(),
                   [&](std::string_view name) { return csv.require(name); });
  }

  std::size_t time, frame, sensor, status;
  std::array<std::size_t, 7> pose{};
  std::optional<std::size_t> error;
};

double finite_or_nan(double value) { return std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN(); }

/// A row without a quaternion is a point: what an optical tracker or an MR coil gives.
bool is_point(const CsvReader& csv, const Columns& columns) {
  return std::all_of(columns.pose.begin(), columns.pose.begin() + 4,
                     [&](std::size_t column) { return csv.text(column).empty(); });
}

SensorReading read_pose(const CsvReader& csv, const Columns& columns) {
  const auto pose = [&](std::size_t i) { return finite_or_nan(csv.number(columns.pose[i])); };
  SensorReading reading;
  reading.status = SensorReading::Status::kOk;
  reading.has_orientation = !is_point(csv, columns);
  if (reading.has_orientation) reading.quaternion_wxyz = {pose(0), pose(1), pose(2), pose(3)};
  const std::array<double, 3> t_mm = {pose(4), pose(5), pose(6)};  // in order: the first wrong field is named
  reading.position_m = position_from_millimetres(t_mm[0], t_mm[1], t_mm[2]);
  if (columns.error && !csv.text(*columns.error).empty()) {
    reading.error_m = csv.number(*columns.error) * kMetresPerMillimetre;
  }
  return reading;
}

SensorReading read_row(const CsvReader& csv, const Columns& columns) {
  if (csv.text(columns.status) == "OK") return read_pose(csv, columns);
  if (csv.text(columns.status) != "MISSING") csv.refuse(columns.status, "OK or MISSING");
  SensorReading missing;
  missing.has_orientation = true;
  return missing;
}

void note_unread_columns(const CsvReader& csv, FrameAssembler& assembler) {
  for (const std::string_view name : csv.columns()) {
    const bool known = name == "time_s" || name == "error_mm" ||
                       std::count(kRowColumns.begin(), kRowColumns.end(), name) ||
                       std::count(kPoseColumns.begin(), kPoseColumns.end(), name);
    if (!known) assembler.note(fmt::format("column {} is not read", printable(name)));
  }
}

}  // namespace

bool looks_like_tracker_csv(std::string_view header) {
  const auto names = split(header, ',');
  const auto is_known = [](std::string_view name) {
    return std::count(kRowColumns.begin(), kRowColumns.end(), name) ||
           std::count(kPoseColumns.begin(), kPoseColumns.end(), name);
  };
  return std::count_if(names.begin(), names.end(), is_known) >= 3;
}

TrackerRecording parse_tracker_csv(const TextFile& file) {
  CsvReader csv(file);
  const Columns columns(csv);
  FrameAssembler assembler(file.name, SensorReading::Status::kAbsent);
  note_unread_columns(csv, assembler);
  bool noted_reuse = false;
  while (csv.next()) {
    if (csv.text(columns.sensor).empty()) csv.refuse(columns.sensor, "the name of a sensor");
    const double time_s = csv.number(columns.time);
    const std::size_t sensor = assembler.sensor(csv.text(columns.sensor), csv.line());
    const std::size_t frame = assembler.frame(csv.integer(columns.frame), time_s);
    const double frame_time_s = assembler.time_s(frame);
    const bool other_time = std::isfinite(time_s) && std::isfinite(frame_time_s) && time_s != frame_time_s;
    if (other_time && !assembler.has(frame, sensor)) {
      csv.refuse(columns.time,
                 fmt::format("{}, the time of the other rows of frame {}", frame_time_s, csv.text(columns.frame)));
    }
    if (other_time && !noted_reuse) {
      noted_reuse = true;
      assembler.note(fmt::format("line {}: frame {} comes again with another time; counted as a duplicate", csv.line(),
                                 csv.text(columns.frame)));
    }
    assembler.put(frame, sensor, read_row(csv, columns));
  }
  TrackerRecording recording = assembler.finish();
  if (recording.frames.empty()) refuse_field(file.name, csv.line(), "row", "", "at least one row after the header");
  return recording;
}

}  // namespace palpate
