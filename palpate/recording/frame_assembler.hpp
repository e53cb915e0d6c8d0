// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <palpate/recording/tracker_recording.hpp>
#include <string>
#include <string_view>

namespace palpate {

/// Gathers readings that come one by one into frames; frames and sensors keep the order in which they first appear.
class FrameAssembler {
 public:
  /// `unwritten`: what it means that a frame has no row of a sensor. kMissing in a format that lists every sensor in
  /// every frame, kAbsent in one that need not.
  explicit FrameAssembler(std::string source, SensorReading::Status unwritten = SensorReading::Status::kMissing) {
    recording_.source = std::move(source);
    unwritten_.status = unwritten;
  }

  /// Index of the sensor, new or known; `line` is where it stands.
  std::size_t sensor(std::string_view name, std::size_t line);
  /// Index of the frame with this number, new or known. A new one gets `time_s`.
  std::size_t frame(std::int64_t number, double time_s);
  double time_s(std::size_t frame) const { return recording_.frames[frame].time_s; }
  /// True where this frame already has a row of this sensor.
  bool has(std::size_t frame, std::size_t sensor) const;
  /// Stores the reading; one that is there already stays, and the duplicate is counted.
  void put(std::size_t frame, std::size_t sensor, const SensorReading& reading);
  void note(std::string text);
  /// Every frame with an entry for every sensor: `unwritten` where nothing was put. The assembler is spent.
  TrackerRecording finish();

 private:
  TrackerRecording recording_;
  SensorReading unwritten_;
  std::map<std::string, std::size_t, std::less<>> sensors_;
  std::map<std::int64_t, std::size_t> frames_;
  std::vector<std::vector<bool>> seen_;  ///< [frame][sensor]
};

/// A position in millimetres as received becomes metres; what is not finite becomes NaN.
Eigen::Vector3d position_from_millimetres(double x_mm, double y_mm, double z_mm);

}  // namespace palpate
