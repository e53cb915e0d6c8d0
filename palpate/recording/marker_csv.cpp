// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <palpate/math/units.hpp>
#include <palpate/recording/marker_csv.hpp>

namespace palpate {
namespace {

struct Marker {
  std::array<std::size_t, 3> columns{};
  double metres_per_unit = 1.0;
};

bool names_x(std::string_view column) {
  return column.size() > 4 && (column.ends_with("_x_m") || column.ends_with("_x_mm"));
}

std::size_t time_column(const CsvReader& csv) {
  if (const auto t_s = csv.find("t_s")) return *t_s;
  return csv.require("time_s");
}

double coordinate(const CsvReader& csv, std::size_t column) {
  return csv.text(column).empty() ? std::numeric_limits<double>::quiet_NaN() : csv.number(column);
}

std::vector<Marker> find_markers(const CsvReader& csv, const TextFile& file, MarkerRecording& recording) {
  std::vector<Marker> markers;
  for (const std::string_view column : csv.columns()) {
    if (!names_x(column)) continue;
    const std::string name(column.substr(0, column.rfind("_x_m")));
    const std::string unit(column.substr(column.rfind('_') + 1));
    Marker marker;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      marker.columns[axis] = csv.require(fmt::format("{}_{}_{}", name, "xyz"[axis], unit));
    }
    marker.metres_per_unit = unit == "mm" ? kMetresPerMillimetre : 1.0;
    if (std::count(recording.names.begin(), recording.names.end(), name) > 0) {
      refuse_field(file.name, 1, "header", column, "each marker once, in m or in mm");
    }
    recording.names.push_back(name);
    markers.push_back(marker);
  }
  if (markers.empty())
    refuse_field(file.name, 1, "header", file.lines[0], "columns NAME_x_m,NAME_y_m,NAME_z_m (or _mm)");
  return markers;
}

}  // namespace

bool looks_like_marker_csv(std::string_view header) {
  const auto columns = split(header, ',');
  return std::any_of(columns.begin(), columns.end(), names_x);
}

MarkerRecording parse_marker_csv(const TextFile& file) {
  CsvReader csv(file);
  MarkerRecording recording;
  recording.source = file.name;
  const std::size_t time = time_column(csv);
  const std::vector<Marker> markers = find_markers(csv, file, recording);
  while (csv.next()) {
    recording.times_s.push_back(csv.number(time));
    auto& positions = recording.positions_m.emplace_back();
    for (const Marker& marker : markers) {
      const auto metres = [&](std::size_t axis) {
        return coordinate(csv, marker.columns[axis]) * marker.metres_per_unit;
      };
      positions.emplace_back(metres(0), metres(1), metres(2));
    }
  }
  if (recording.times_s.empty()) refuse_field(file.name, csv.line(), "row", "", "at least one row after the header");
  return recording;
}

}  // namespace palpate
