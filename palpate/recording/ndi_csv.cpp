// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <palpate/recording/frame_assembler.hpp>
#include <palpate/recording/ndi_csv.hpp>
#include <span>

namespace palpate {
namespace {

constexpr std::size_t kRowFields = 5;  // sample, hour, minutes, seconds, ms
constexpr std::size_t kPoseFields = 7;
constexpr std::array<std::string_view, kRowFields> kRowColumns = {"Sample:", "Hour", "Minutes", "Seconds", "ms"};
constexpr std::array<std::string_view, kPoseFields> kPoseColumns = {"X", "Y", "Z", "qo", "qx", "qy", "qz"};
constexpr double kSecondsPerDay = 86400.0;

using Fields = std::vector<std::string_view>;

/// Lines end in a delimiter: the empty field behind it is none.
Fields split_row(std::string_view line) {
  Fields fields = split(line, ',');
  if (fields.back().empty()) fields.pop_back();
  return fields;
}

std::size_t find_header(const TextFile& file) {
  const auto found =
      std::find_if(file.lines.begin(), file.lines.end(), [](const auto& line) { return line.starts_with("Sample:"); });
  if (found == file.lines.end()) {
    refuse_field(file.name, file.lines.size(), "header", "", "a line that starts with 'Sample:' after the preamble");
  }
  return static_cast<std::size_t>(found - file.lines.begin()) + 1;
}

std::vector<std::string> sensor_names(const TextFile& file, std::size_t line, const Fields& columns) {
  const auto check = [&](std::size_t i, std::string_view expected) {
    if (i < columns.size() && columns[i] == expected) return;
    refuse_field(file.name, line, "header", i < columns.size() ? columns[i] : "",
                 fmt::format("column {} to be {}", i + 1, expected));
  };
  for (std::size_t i = 0; i < kRowFields; ++i) check(i, kRowColumns[i]);
  std::vector<std::string> names;
  for (std::size_t i = kRowFields; i < columns.size() || names.empty(); i += kPoseFields) {
    const std::string name(i < columns.size() && columns[i].starts_with('X') ? columns[i].substr(1) : "a");
    for (std::size_t k = 0; k < kPoseFields; ++k) check(i + k, std::string(kPoseColumns[k]) + name);
    if (std::find(names.begin(), names.end(), name) != names.end()) {
      refuse_field(file.name, line, "header", columns[i], "each column once");
    }
    names.push_back(name);
  }
  return names;
}

/// Reads the numbers of one row; the header names them in messages.
class Row {
 public:
  Row(const TextFile& file, std::size_t line, const Fields& columns)
      : file_(file), line_(line), columns_(columns), fields_(split_row(file.lines[line - 1])) {
    const bool last = line == file.lines.size() && !file.ends_with_newline;
    cut_ = last && fields_.size() < columns.size();
    // Where the line is cut, a field is whole only if its delimiter follows.
    whole_ = cut_ ? split(file.lines[line - 1], ',').size() - 1 : fields_.size();
    if (fields_.size() != columns.size() && !cut_) {
      refuse_field(file.name, line, "row", file.lines[line - 1],
                   fmt::format("{} fields, found {}", columns.size(), fields_.size()));
    }
  }

  bool cut() const { return cut_; }
  bool is_whole(std::size_t end) const { return end <= whole_; }

  double number(std::size_t i) const {
    if (const auto value = parse_number(fields_[i])) return *value;
    refuse_field(file_.name, line_, columns_[i], fields_[i], "a number");
  }

  std::int64_t integer(std::size_t i) const {
    if (const auto value = parse_integer(fields_[i])) return *value;
    refuse_field(file_.name, line_, columns_[i], fields_[i], "an integer");
  }

  double time_of_day_s() const { return 3600.0 * number(1) + 60.0 * number(2) + number(3) + 1e-3 * number(4); }

  SensorReading reading(std::size_t first) const {
    SensorReading reading;
    reading.has_orientation = true;
    if (!is_whole(first + kPoseFields)) return reading;
    std::array<double, kPoseFields> v{};
    for (std::size_t k = 0; k < kPoseFields; ++k) v[k] = number(first + k);
    if (std::all_of(v.begin(), v.end(), [](double value) { return value == 0.0; })) return reading;
    reading.status = SensorReading::Status::kOk;
    reading.position_m = position_from_millimetres(v[0], v[1], v[2]);
    reading.quaternion_wxyz << v[3], v[4], v[5], v[6];
    return reading;
  }

 private:
  const TextFile& file_;
  std::size_t line_;
  const Fields& columns_;
  Fields fields_;
  std::size_t whole_ = 0;
  bool cut_ = false;
};

/// Seconds since the first row, from times of day that start again at midnight.
class DayClock {
 public:
  double since_start(double time_of_day_s) {
    if (!std::isfinite(time_of_day_s)) return time_of_day_s;
    if (!started_) first_s_ = last_s_ = time_of_day_s;
    started_ = true;
    if (time_of_day_s < last_s_ - 0.5 * kSecondsPerDay) days_s_ += kSecondsPerDay;
    last_s_ = time_of_day_s;
    return days_s_ + time_of_day_s - first_s_;
  }

 private:
  bool started_ = false;
  double first_s_ = 0.0;
  double last_s_ = 0.0;
  double days_s_ = 0.0;
};

}  // namespace

TrackerRecording parse_ndi_csv(const TextFile& file) {
  const std::size_t header = find_header(file);
  const Fields columns = split_row(file.lines[header - 1]);
  FrameAssembler assembler(file.name);
  for (const std::string& name : sensor_names(file, header, columns)) assembler.sensor(name, header);
  DayClock clock;
  for (std::size_t line = header + 1; line <= file.lines.size(); ++line) {
    if (trim(file.lines[line - 1]).empty()) continue;
    const Row row(file, line, columns);
    if (row.cut()) assembler.note(fmt::format("line {}: truncated last row, read as far as it is whole", line));
    if (!row.is_whole(kRowFields)) break;
    const std::size_t frame = assembler.frame(row.integer(0), clock.since_start(row.time_of_day_s()));
    for (std::size_t i = kRowFields, sensor = 0; i < columns.size(); i += kPoseFields, ++sensor) {
      assembler.put(frame, sensor, row.reading(i));
    }
  }
  TrackerRecording recording = assembler.finish();
  if (recording.frames.empty()) refuse_field(file.name, header, "row", "", "at least one row after the header");
  return recording;
}

}  // namespace palpate
