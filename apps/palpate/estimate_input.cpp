// SPDX-License-Identifier: Apache-2.0
#include "estimate_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/handle_csv.hpp>
#include <palpate/recording/merge_recordings.hpp>
#include <palpate/recording/tendon_csv.hpp>
#include <palpate/sensing/screening.hpp>

namespace palpate::app {

namespace {

/// Where the usable positions of one sensor lie.
struct Extent {
  double nearest_to_base_m = std::numeric_limits<double>::infinity();
  double farthest_from_base_m = 0.0;
  double farthest_from_origin_m = 0.0;
};

Extent extent_of(const TrackerRecording& recording, std::size_t i, SensorKind kind, const Vector3d& base_m) {
  Extent extent;
  for (const TrackerFrame& frame : recording.frames) {
    const SensorReading& reading = frame.readings[i];
    if (screen(reading, kind) != Rejection::kNone) continue;
    const double to_base_m = (reading.position_m - base_m).norm();
    extent.nearest_to_base_m = std::min(extent.nearest_to_base_m, to_base_m);
    extent.farthest_from_base_m = std::max(extent.farthest_from_base_m, to_base_m);
    extent.farthest_from_origin_m = std::max(extent.farthest_from_origin_m, reading.position_m.norm());
  }
  return extent;
}

/// A recording in metres, or of another setup, keeps a sensor where the shaft cannot hold it. What a tracked base knows
/// of is not judged.
void check_reach(const Catheter& catheter, const TrackerRecording& recording) {
  const double reach_m =
      1.5 * (catheter.rod.length_m() + catheter.rod.rigid_tip_m) + 0.02 + 4.0 * catheter.base.position_sigma_m;
  constexpr double kAsIfMetres_m = 2e-3;  // two metres, read as millimetres
  for (std::size_t i = 0; i < catheter.sensors.size(); ++i) {
    const Sensor& sensor = catheter.sensors[i];
    if (catheter.base.tracked && !sensor.T_tracker_base) continue;
    const std::string& source = recording.sensor_sources.empty() ? recording.source : recording.sensor_sources[i];
    const Extent extent = extent_of(recording, i, sensor.kind, catheter.T_tracker_base(sensor).p);
    if (!std::isfinite(extent.nearest_to_base_m)) continue;
    const bool tiny = extent.farthest_from_origin_m < kAsIfMetres_m;
    if (tiny && extent.farthest_from_base_m < 0.2 * sensor.arc_length_m)
      throw InputError(fmt::format(
          "{}: sensor \"{}\": never farther than {:.4g} mm from the base, though {:.4g} mm along the shaft: "
          "expected millimetres; are the positions in metres?",
          source, sensor.name, extent.farthest_from_base_m * kMillimetresPerMetre,
          sensor.arc_length_m * kMillimetresPerMetre));
    if (extent.nearest_to_base_m > reach_m)
      throw InputError(fmt::format(
          "{}: sensor \"{}\": never nearer than {:.4g} mm to the base of the catheter file: expected at "
          "most {:.4g} mm; "
          "{}",
          source, sensor.name, extent.nearest_to_base_m * kMillimetresPerMetre, reach_m * kMillimetresPerMetre,
          tiny                    ? "are the positions in metres instead of millimetres?"
          : sensor.T_tracker_base ? "is its base_position_mm that of this setup?"
                                  : "is [base] that of this setup?"));
  }
}

[[noreturn]] void refuse_span_without_frames(std::string_view what, double from_s, double to_s,
                                             const TrackerRecording& recording) {
  throw InputError(fmt::format("{}: {} {}:{} s: expected an interval with frames; the recording goes from {} s to {} s",
                               recording.source, what, from_s, to_s, recording.frames.front().time_s,
                               recording.frames.back().time_s));
}

void check_reference(const ReferenceInterval& reference, const TrackerRecording& recording) {
  if (!reference.given) return;
  const auto inside = [&](const TrackerFrame& frame) {
    return frame.time_s >= reference.from_s && frame.time_s <= reference.to_s;
  };
  if (std::any_of(recording.frames.begin(), recording.frames.end(), inside)) return;
  refuse_span_without_frames("reference", reference.from_s, reference.to_s, recording);
}

/// Times in milliseconds look like frames seconds apart.
void warn_of_slow_frames(const TrackerRecording& recording, std::vector<std::string>& warnings) {
  if (recording.frames.size() < 10) return;
  std::vector<double> periods_s;
  for (std::size_t i = 1; i < recording.frames.size(); ++i)
    periods_s.push_back(recording.frames[i].time_s - recording.frames[i - 1].time_s);
  std::erase_if(periods_s, [](double period_s) { return !std::isfinite(period_s); });
  if (periods_s.empty()) return;
  std::nth_element(periods_s.begin(), periods_s.begin() + static_cast<std::ptrdiff_t>(periods_s.size() / 2),
                   periods_s.end());
  const double period_s = periods_s[periods_s.size() / 2];
  if (period_s > 1.0)
    warnings.push_back(
        fmt::format("{}: its frames are {:.4g} s apart: are the times in milliseconds?", recording.source, period_s));
}

/// The handle's bend in every frame. It stands in place of the tendon's moment, which bends the same shaft.
void attach_bend(const std::string& path, const Catheter& catheter, TrackerRecording& recording,
                 std::vector<std::string>& warnings) {
  const HandleTrace handle = read_handle_csv(path, catheter.tendon_map.input);
  const TendonPlay play(catheter.tendon_map, catheter.precurvature_per_m().head<2>());
  std::vector<double> times_s;
  times_s.reserve(recording.frames.size());
  for (const TrackerFrame& frame : recording.frames) times_s.push_back(frame.time_s);
  const BendTrace trace = bends_at(handle, play, times_s);
  for (std::size_t i = 0; i < recording.frames.size(); ++i) recording.frames[i].bend = trace.bends[i];
  if (handle.has_moments)
    warnings.push_back(
        fmt::format("{}: its moments are left out, for [tendon_map] says how far the handle bends the shaft", path));
  if (trace.outside > 0)
    warnings.push_back(
        fmt::format("{}: {} frames lie outside its time span: the nearest position was taken", path, trace.outside));
  if (trace.beyond_the_map > 0)
    warnings.push_back(fmt::format(
        "{}: in {} frames the handle is beyond the ends of [tendon_map]: the bend of the end was taken, with a sigma "
        "that grows with the distance",
        path, trace.beyond_the_map));
}

void attach_tendon(const std::string& path, const Catheter& catheter, TrackerRecording& recording,
                   std::vector<std::string>& warnings) {
  if (path.empty()) {
    const auto brings_moment = [](const TrackerFrame& frame) { return frame.tendon.present; };
    if (std::any_of(recording.frames.begin(), recording.frames.end(), brings_moment)) return;
    if (catheter.tendon_map.present)
      warnings.emplace_back(
          "tendon_map: the catheter file has one, but no --tendon was given: precurvature_per_m is taken instead");
    if (catheter.tendon.present)
      warnings.emplace_back(
          "tendon: the catheter file has one, but no --tendon was given: its moment is taken as zero");
    return;
  }
  if (catheter.tendon_map.present) return attach_bend(path, catheter, recording, warnings);
  if (!catheter.tendon.present)
    throw InputError(fmt::format("--tendon {}: the catheter file has no [tendon]: expected its model", path));
  const TendonTrace trace = read_tendon_csv(path, catheter.tendon);
  std::size_t outside = 0;
  for (TrackerFrame& frame : recording.frames) {
    if (!std::isfinite(frame.time_s)) continue;
    const TendonTrace::Sample sample = trace.interpolate(frame.time_s);
    outside += sample.inside ? 0 : 1;
    frame.tendon = {.present = true, .moment_Nm = sample.moment_Nm, .sigma_Nm = sample.sigma_Nm};
  }
  if (outside > 0)
    warnings.push_back(
        fmt::format("{}: {} frames lie outside its time span: the nearest moment was taken", path, outside));
}

/// An interval without frames is one of another recording, or of another clock.
void attach_loads(const std::vector<KnownLoadInterval>& intervals, TrackerRecording& recording) {
  const std::vector<std::size_t> inside = attach_known_loads(intervals, recording.frames);
  for (std::size_t i = 0; i < intervals.size(); ++i)
    if (inside[i] == 0) refuse_span_without_frames("known_load", intervals[i].from_s, intervals[i].to_s, recording);
}

std::vector<TrackerRecording> read_sources(const EstimateOptions& options, const CatheterFile& file) {
  std::vector<TrackerRecording> sources;
  for (const std::string& path : options.recordings)
    sources.push_back(read_tracker_recording(path, {.catheter = &file.catheter,
                                                    .reference_from_s = file.reference.from_s,
                                                    .reference_to_s = file.reference.to_s,
                                                    .reference_straight = file.reference.straight,
                                                    .one_of_several = options.recordings.size() > 1}));
  return sources;
}

}  // namespace

TrackerRecording load_recording(const EstimateOptions& options, const CatheterFile& file,
                                std::vector<std::string>& warnings) {
  return prepare_recording(read_sources(options, file), options, file, warnings);
}

TrackerRecording prepare_recording(std::vector<TrackerRecording> sources, const EstimateOptions& options,
                                   const CatheterFile& file, std::vector<std::string>& warnings) {
  std::vector<std::string> remarks;
  for (TrackerRecording& source : sources) {
    for (const std::string& note : source.notes) warnings.push_back(fmt::format("{}: {}", source.source, note));
    warn_of_slow_frames(source, remarks);
    correct_delay(source, file.catheter);
  }
  TrackerRecording recording = merge_recordings(std::move(sources), file.ignore_sensors);
  bind_to_catheter(recording, file.catheter, file.ignore_sensors);
  if (recording.frames.empty()) throw InputError(fmt::format("{}: expected at least one frame", recording.source));
  check_reference(file.reference, recording);
  check_reach(file.catheter, recording);
  warnings.insert(warnings.end(), remarks.begin(), remarks.end());
  attach_loads(file.known_loads, recording);
  attach_tendon(options.tendon, file.catheter, recording, warnings);
  return recording;
}

void refuse_passed_over_rows(const TrackerRecording& recording) {
  if (recording.duplicate_rows == 0) return;
  const std::string& source =
      recording.first_duplicate_source.empty() ? recording.source : recording.first_duplicate_source;
  throw InputError(fmt::format("{}: {}: {} in all: expected one row a sensor a frame (--strict)", source,
                               recording.first_duplicate, recording.duplicate_rows));
}

void refuse_passed_over_readings(const TrackerRecording& recording, const TrackerFrame& frame,
                                 const Estimate& estimate) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("{}: frame {} at {} s: {} (--strict)", source_of(recording, frame), frame.number,
                                 frame.time_s, what));
  };
  if (estimate.time == FrameTime::kStandsStill)
    refuse("time stands still: expected a later time than the frame before");
  if (estimate.time == FrameTime::kStepsBack || estimate.time == FrameTime::kResynchronised)
    refuse("time steps back: expected a later time than the frame before");
  if (estimate.time == FrameTime::kNotFinite) refuse("time is not finite: expected seconds");
  for (std::size_t i = 0; i < frame.readings.size(); ++i) {
    const Rejection reason = estimate.rejections[i];
    if (reason == Rejection::kNone || reason == Rejection::kMissing || reason == Rejection::kAbsent) continue;
    refuse(fmt::format("sensor \"{}\": {}", recording.sensor_names[i], describe(reason)));
  }
  const auto& readings = frame.readings;
  const auto is = [](SensorReading::Status status) {
    return [=](const SensorReading& reading) { return reading.status == status; };
  };
  const bool all_missing = std::all_of(readings.begin(), readings.end(), is(SensorReading::Status::kMissing));
  const bool held_for_want_of_one = estimate.status == EstimateStatus::kHeld &&
                                    std::any_of(readings.begin(), readings.end(), is(SensorReading::Status::kAbsent));
  if (estimate.used == 0 && !all_missing && !held_for_want_of_one)
    refuse(fmt::format("status {}: expected at least one usable sensor", describe(estimate.status)));
}

}  // namespace palpate::app
