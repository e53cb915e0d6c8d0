// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <palpate/math/pose.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <span>
#include <vector>

namespace palpate {

/// Part of a recording, both ends included.
struct NoiseInterval {
  double from_s = -std::numeric_limits<double>::infinity();
  double to_s = std::numeric_limits<double>::infinity();
};

/// How regularly a sensor speaks.
struct SensorTiming {
  double duration_s = 0.0;     ///< first to last usable reading
  double mean_rate_Hz = 0.0;   ///< usable readings, over the duration
  double period_s = 0.0;       ///< median time between usable readings
  double jitter_s = 0.0;       ///< standard deviation of that time
  double longest_gap_s = 0.0;  ///< and its largest
};

/// What a recording holds of one sensor.
struct SensorRecord {
  bool has_orientation = false;
  std::size_t frames = 0;     ///< that speak of the sensor
  std::size_t missing = 0;    ///< the tracker did not see it
  std::size_t unusable = 0;   ///< NaN, no rotation, identity: sensing/screening.hpp
  std::size_t bad_times = 0;  ///< usable, but not later than the reading before
  SensorTiming timing;
};

/// The usable readings of one sensor in time order, and how many were not usable.
struct SensorSamples : SensorRecord {
  std::vector<double> times_s;
  std::vector<Pose> poses;                        ///< sensor in the tracker
  std::vector<Eigen::Vector4d> quaternions_wxyz;  ///< as received; empty where there is no orientation

  std::size_t size() const { return poses.size(); }
  /// Exactly the same numbers, as a device repeats them that is asked faster than it measures.
  bool same(std::size_t i, std::size_t j) const;
  /// Readings that differ from the one before.
  std::size_t count_distinct() const;
  /// Those of the listed readings.
  SensorSamples pick(const std::vector<std::size_t>& which) const;
};

/// `sensor`: its place in TrackerFrame::readings. Frames whose time is no number are passed over.
SensorSamples collect_samples(std::span<const TrackerFrame> frames, std::size_t sensor,
                              const NoiseInterval& interval = {});

}  // namespace palpate
