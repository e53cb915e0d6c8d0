// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <palpate/math/units.hpp>
#include <palpate/recording/frame_assembler.hpp>
#include <palpate/recording/text_table.hpp>
#include <utility>

namespace palpate {

std::size_t FrameAssembler::sensor(std::string_view name, std::size_t line) {
  if (const auto known = sensors_.find(name); known != sensors_.end()) return known->second;
  const std::size_t index = sensors_.size();
  sensors_.emplace(name, index);
  recording_.sensor_names.emplace_back(name);
  recording_.sensor_lines.push_back(line);
  return index;
}

std::size_t FrameAssembler::frame(std::int64_t number, double time_s) {
  const auto [place, is_new] = frames_.try_emplace(number, recording_.frames.size());
  if (is_new) {
    TrackerFrame& added = recording_.frames.emplace_back();
    added.time_s = time_s;
    added.number = number;
    seen_.emplace_back();
  }
  return place->second;
}

bool FrameAssembler::has(std::size_t frame, std::size_t sensor) const {
  return sensor < seen_[frame].size() && seen_[frame][sensor];
}

void FrameAssembler::put(std::size_t frame, std::size_t sensor, const SensorReading& reading) {
  if (has(frame, sensor)) {
    const TrackerFrame& again = recording_.frames[frame];
    if (recording_.duplicate_rows++ == 0)
      recording_.first_duplicate = fmt::format("frame {} at {} s: sensor \"{}\": a second row", again.number,
                                               again.time_s, printable(recording_.sensor_names[sensor]));
    return;
  }
  auto& readings = recording_.frames[frame].readings;
  if (readings.size() <= sensor) readings.resize(sensor + 1, unwritten_);
  if (seen_[frame].size() <= sensor) seen_[frame].resize(sensor + 1, false);
  readings[sensor] = reading;
  seen_[frame][sensor] = true;
}

void FrameAssembler::note(std::string text) { recording_.notes.push_back(std::move(text)); }

TrackerRecording FrameAssembler::finish() {
  for (TrackerFrame& frame : recording_.frames) frame.readings.resize(recording_.sensor_names.size(), unwritten_);
  return std::move(recording_);
}

Eigen::Vector3d position_from_millimetres(double x_mm, double y_mm, double z_mm) {
  const auto metres = [](double value_mm) {
    return std::isfinite(value_mm) ? value_mm * kMetresPerMillimetre : std::numeric_limits<double>::quiet_NaN();
  };
  return {metres(x_mm), metres(y_mm), metres(z_mm)};
}

}  // namespace palpate
