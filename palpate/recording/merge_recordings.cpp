// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <palpate/math/errors.hpp>
#include <palpate/observer/frame_clock.hpp>
#include <palpate/recording/merge_recordings.hpp>
#include <palpate/recording/text_table.hpp>
#include <tuple>

namespace palpate {
namespace {

/// Where a frame of one source goes among those of all.
struct Slot {
  double place_s = 0.0;  ///< its time; where its own clock rejects that, the time of the frame it stays behind
  bool rejected = false;
  std::size_t source = 0;
  TrackerFrame* frame = nullptr;

  auto order() const { return std::tuple(place_s, rejected); }
};

void place_frames(std::vector<TrackerRecording>& recordings, std::size_t source, std::vector<Slot>& slots) {
  FrameClock clock;
  double place_s = -std::numeric_limits<double>::infinity();
  for (TrackerFrame& frame : recordings[source].frames) {
    const FrameClock::Step step = clock.advance(frame.time_s);
    if (step.verdict == FrameTime::kResynchronised)
      throw InputError(fmt::format(
          "{}: frame {}: field time_s: value '{}': expected times that run on after {} s, for recordings are merged by "
          "time; was the clock set back?",
          recordings[source].source, frame.number, frame.time_s, place_s));
    if (step.accepted()) place_s = frame.time_s;
    slots.push_back({place_s, !step.accepted(), source, &frame});
  }
}

/// Sensors of all sources side by side, and in which column of those each source's readings go.
class SensorColumns {
 public:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  void add_source(const TrackerRecording& recording, const std::vector<std::string>& ignore, TrackerRecording& merged) {
    std::vector<std::size_t>& columns = columns_.emplace_back();
    for (std::size_t i = 0; i < recording.sensor_names.size(); ++i) {
      const std::string& name = recording.sensor_names[i];
      const auto known = std::find(merged.sensor_names.begin(), merged.sensor_names.end(), name);
      const bool is_new = known == merged.sensor_names.end();
      if (!is_new && std::find(ignore.begin(), ignore.end(), name) == ignore.end())
        refuse_twice(recording, i,
                     merged.sensor_sources[static_cast<std::size_t>(known - merged.sensor_names.begin())]);
      columns.push_back(is_new ? merged.sensor_names.size() : kNone);
      if (!is_new) continue;
      merged.sensor_names.push_back(name);
      merged.sensor_lines.push_back(line_of(recording, i));
      merged.sensor_sources.push_back(recording.source);
    }
  }

  void put(std::size_t source, const TrackerFrame& from, TrackerFrame& to) const {
    for (std::size_t i = 0; i < from.readings.size(); ++i)
      if (columns_[source][i] != kNone) to.readings[columns_[source][i]] = from.readings[i];
  }

 private:
  static std::size_t line_of(const TrackerRecording& recording, std::size_t i) {
    return i < recording.sensor_lines.size() ? recording.sensor_lines[i] : 0;
  }

  [[noreturn]] static void refuse_twice(const TrackerRecording& recording, std::size_t i, const std::string& other) {
    const std::size_t line = line_of(recording, i);
    throw InputError(fmt::format("{}{}: field sensor: value '{}': expected each sensor in one recording; {} has it too",
                                 recording.source, line > 0 ? fmt::format(":{}", line) : "",
                                 printable(recording.sensor_names[i]), other));
  }

  std::vector<std::vector<std::size_t>> columns_;  ///< [source][sensor of the source]
};

void add_remarks(TrackerRecording& recording, TrackerRecording& merged) {
  merged.source += merged.source.empty() ? recording.source : ", " + recording.source;
  std::move(recording.notes.begin(), recording.notes.end(), std::back_inserter(merged.notes));
  if (merged.duplicate_rows == 0 && recording.duplicate_rows > 0) {
    merged.first_duplicate = recording.first_duplicate;
    merged.first_duplicate_source = recording.source;
  }
  merged.duplicate_rows += recording.duplicate_rows;
}

}  // namespace

TrackerRecording merge_recordings(std::vector<TrackerRecording> recordings,
                                  const std::vector<std::string>& ignore_sensors) {
  if (recordings.size() == 1) return std::move(recordings.front());
  TrackerRecording merged;
  SensorColumns columns;
  std::vector<Slot> slots;
  for (std::size_t source = 0; source < recordings.size(); ++source) {
    columns.add_source(recordings[source], ignore_sensors, merged);
    add_remarks(recordings[source], merged);
    place_frames(recordings, source, slots);
  }
  std::stable_sort(slots.begin(), slots.end(), [](const Slot& a, const Slot& b) { return a.order() < b.order(); });

  const SensorReading absent{.status = SensorReading::Status::kAbsent};
  const Slot* last = nullptr;
  for (const Slot& slot : slots) {
    const bool joins = last != nullptr && !slot.rejected && slot.order() == last->order();
    if (!joins) {
      TrackerFrame& frame = merged.frames.emplace_back();
      frame.time_s = slot.frame->time_s;
      frame.number = slot.frame->number;
      frame.tendon = slot.frame->tendon;
      frame.readings.assign(merged.sensor_names.size(), absent);
    }
    columns.put(slot.source, *slot.frame, merged.frames.back());
    slot.frame->readings = {};  // of no further use: the merged frames hold them
    last = &slot;
  }
  return merged;
}

void correct_delay(TrackerRecording& recording, const Catheter& catheter) {
  std::vector<const Sensor*> sensors;
  const auto add = [&](const Sensor& sensor) {
    const auto& names = recording.sensor_names;
    if (std::find(names.begin(), names.end(), sensor.name) != names.end()) sensors.push_back(&sensor);
  };
  for (const Sensor& sensor : catheter.sensors) add(sensor);
  if (catheter.base.tracked) add(catheter.base.sensor);
  if (sensors.empty()) return;
  const Sensor& first = *sensors.front();
  for (const Sensor* sensor : sensors)
    if (sensor->delay_s != first.delay_s)
      throw InputError(
          fmt::format("{}: sensor \"{}\": delay_s = {} in the catheter file: expected {}, that of sensor \"{}\", for "
                      "the two share the frames of this recording",
                      recording.source, sensor->name, sensor->delay_s, first.delay_s, first.name));
  if (first.delay_s == 0.0) return;
  for (TrackerFrame& frame : recording.frames) frame.time_s -= first.delay_s;
}

}  // namespace palpate
