// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <palpate/recording/frame_assembler.hpp>
#include <palpate/recording/plus_sequence.hpp>
#include <palpate/sensing/rounded_rotation.hpp>
#include <set>

namespace palpate {
namespace {

constexpr std::string_view kDataField = "ElementDataFile";
constexpr std::string_view kFramePrefix = "Seq_Frame";
constexpr std::string_view kTransform = "Transform";
constexpr std::string_view kTransformStatus = "TransformStatus";

struct Field {
  std::string_view text;
  std::size_t line = 0;
};

/// Fields of one frame by their name without `Seq_FrameNNNN_`.
struct SequenceFrame {
  std::map<std::string_view, Field> fields;
  std::size_t last_line = 0;
};

using SequenceFrames = std::map<std::int64_t, SequenceFrame>;

void add_line(const TextFile& file, std::size_t line, SequenceFrames& frames) {
  const std::string_view text = file.lines[line - 1];
  if (trim(text).empty()) return;
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos) refuse_field(file.name, line, "header", text, "NAME = VALUE");
  const std::string_view name = trim(text.substr(0, equals));
  if (!name.starts_with(kFramePrefix)) return;
  const std::string_view rest = name.substr(kFramePrefix.size());
  const std::size_t bar = rest.find('_');
  const auto index = parse_integer(rest.substr(0, bar));
  if (bar == std::string_view::npos || !index) refuse_field(file.name, line, "name", name, "Seq_FrameNNNN_FIELD");
  SequenceFrame& frame = frames[*index];
  if (!frame.fields.try_emplace(rest.substr(bar + 1), Field{trim(text.substr(equals + 1)), line}).second) {
    refuse_field(file.name, line, name, trim(text.substr(equals + 1)), "each field of a frame once");
  }
  frame.last_line = line;
}

/// Where the file is cut off inside its header, a last line without newline may be half a line: it is left out, and so
/// is a last frame without its time.
SequenceFrames gather_frames(const TextFile& file, FrameAssembler& assembler) {
  SequenceFrames frames;
  const bool cut = !file.stopped && !file.ends_with_newline;
  const std::size_t count = file.lines.size() - (cut ? 1 : 0);
  for (std::size_t line = 1; line <= count; ++line) add_line(file, line, frames);
  if (!file.stopped) {
    if (!frames.empty() && !frames.rbegin()->second.fields.contains("Timestamp")) frames.erase(std::prev(frames.end()));
    assembler.note(fmt::format("line {}: the file ends before {}: truncated, read as far as it is whole",
                               file.lines.size(), kDataField));
  }
  return frames;
}

std::string full_name(std::int64_t index, std::string_view field) {
  return fmt::format("{}{:04}_{}", kFramePrefix, index, field);
}

double required_time(const TextFile& file, std::int64_t index, const SequenceFrame& frame) {
  const auto found = frame.fields.find("Timestamp");
  const Field field = found == frame.fields.end() ? Field{"", frame.last_line} : found->second;
  if (const auto time_s = parse_number(field.text)) return *time_s;
  refuse_field(file.name, field.line, full_name(index, "Timestamp"), field.text, "a time in seconds");
}

std::int64_t frame_number(const TextFile& file, std::int64_t index, const SequenceFrame& frame) {
  const auto found = frame.fields.find("FrameNumber");
  if (found == frame.fields.end()) return index;
  if (const auto number = parse_integer(found->second.text)) return *number;
  refuse_field(file.name, found->second.line, full_name(index, "FrameNumber"), found->second.text, "an integer");
}

using Matrix4Rows = std::array<double, 16>;

Matrix4Rows parse_matrix(const TextFile& file, std::int64_t index, std::string_view name, const Field& field) {
  const auto texts = split_blank(field.text);
  Matrix4Rows m{};
  bool whole = texts.size() == m.size();
  for (std::size_t i = 0; whole && i < m.size(); ++i) {
    const auto value = parse_number(texts[i]);
    whole = value.has_value();
    m[i] = value.value_or(0.0);
  }
  if (!whole) refuse_field(file.name, field.line, full_name(index, name), field.text, "16 numbers, a row-major 4x4");
  return m;
}

SensorReading to_reading(const Matrix4Rows& m, bool valid) {
  SensorReading reading;
  reading.has_orientation = true;
  const bool all_zero = std::all_of(m.begin(), m.end(), [](double value) { return value == 0.0; });
  if (!valid || all_zero) return reading;
  Matrix3d R;
  R << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
  reading.status = SensorReading::Status::kOk;
  reading.quaternion_wxyz = nearest_quaternion(R);
  reading.position_m = position_from_millimetres(m[3], m[7], m[11]);
  return reading;
}

/// A transform whose status is absent counts as OK.
bool status_ok(const TextFile& file, std::int64_t index, const SequenceFrame& frame, const std::string& status_name) {
  const auto found = frame.fields.find(status_name);
  if (found == frame.fields.end() || found->second.text == "OK") return true;
  if (found->second.text == "INVALID" || found->second.text == "MISSING") return false;
  refuse_field(file.name, found->second.line, full_name(index, status_name), found->second.text, "OK or INVALID");
}

std::string_view sensor_name(std::string_view field) {
  constexpr std::string_view kToTracker = "ToTracker";
  std::string_view name = field.substr(0, field.size() - kTransform.size());
  if (name.size() > kToTracker.size() && name.ends_with(kToTracker)) name.remove_suffix(kToTracker.size());
  return name;
}

void add_transforms(const TextFile& file, std::int64_t index, const SequenceFrame& frame, std::size_t slot,
                    FrameAssembler& assembler) {
  for (const auto& [name, field] : frame.fields) {
    if (!name.ends_with(kTransform) || name.size() == kTransform.size()) continue;
    const bool valid = status_ok(file, index, frame, std::string(name) + "Status");
    const std::size_t sensor = assembler.sensor(sensor_name(name), field.line);
    assembler.put(slot, sensor, to_reading(parse_matrix(file, index, name, field), valid));
  }
}

void note_skipped_fields(const SequenceFrame& frame, std::set<std::string_view>& noted, FrameAssembler& assembler) {
  static const std::set<std::string_view> kKnown = {"Timestamp", "UnfilteredTimestamp", "FrameNumber", "ImageStatus"};
  for (const auto& [name, field] : frame.fields) {
    if (name.ends_with(kTransform) || name.ends_with(kTransformStatus) || kKnown.contains(name)) continue;
    if (!noted.insert(name).second) continue;
    assembler.note(fmt::format("line {}: field {} is not a transform; not read", field.line, printable(name)));
  }
}

/// Gaps in the device's own frame numbers are samples that never arrived.
void note_lost_frames(TrackerRecording& recording) {
  std::int64_t lost = 0;
  for (std::size_t i = 1; i < recording.frames.size(); ++i) {
    std::int64_t step = 0;
    if (__builtin_sub_overflow(recording.frames[i].number, recording.frames[i - 1].number, &step)) continue;
    if (step > 1 && lost < std::numeric_limits<std::int64_t>::max() - step) lost += step - 1;
  }
  if (lost > 0) recording.notes.push_back(fmt::format("frames_lost: {} by gaps in FrameNumber", lost));
}

}  // namespace

TrackerRecording read_plus_sequence(const std::filesystem::path& path) {
  return parse_plus_sequence(read_text_file(path, kDataField));
}

TrackerRecording parse_plus_sequence(const TextFile& file) {
  FrameAssembler assembler(file.name);
  const SequenceFrames frames = gather_frames(file, assembler);
  std::vector<std::int64_t> numbers;
  std::set<std::string_view> noted;
  for (const auto& [index, frame] : frames) {
    const std::size_t slot = assembler.frame(index, required_time(file, index, frame));
    numbers.push_back(frame_number(file, index, frame));
    add_transforms(file, index, frame, slot, assembler);
    note_skipped_fields(frame, noted, assembler);
  }
  TrackerRecording recording = assembler.finish();
  if (recording.sensor_names.empty()) {
    refuse_field(file.name, file.lines.size(), "Seq_FrameNNNN_<From>To<To>Transform", "", "at least one transform");
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) recording.frames[i].number = numbers[i];
  note_lost_frames(recording);
  return recording;
}

}  // namespace palpate
