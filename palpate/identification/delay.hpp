// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <palpate/math/rotation.hpp>
#include <span>
#include <vector>

/// Time offset between a tracker, through the force it feels, and a force sensor:
///
///   F_tracker(t) = g F_sensor(t - d) + b + noise,   d = arg min sum_i |(F_tracker - g F_sensor - b)(t_i) / sigma_i|^2
///
/// d > 0: the tracker's time stamps are later than the force sensor's, as Sensor::delay_s. g takes up a wrong
/// stiffness, b (per axis) the drift of a force sensor's zero.
namespace palpate {

struct TimedForce {
  double time_s = 0.0;
  Vector3d force_N = Vector3d::Zero();  ///< tip axes
  Vector3d sigma_N = Vector3d::Ones();  ///< weights of the tracker's force; not used of the force sensor's
};

struct DelayOptions {
  double max_delay_s = 0.5;  ///< sought in [-max, max]; > 0
  bool free_gain = true;     ///< false: g = 1
};

struct DelayFit {
  double delay_s = 0.0;  ///< d
  /// One standard deviation. The residuals' own scatter and correlation in time make it, not the stated sigmas.
  double sigma_s = 0.0;
  double gain = 1.0, gain_sigma = 0.0;   ///< g
  Vector3d offset_N = Vector3d::Zero();  ///< b
  double rms_N = 0.0;                    ///< of the residuals, all axes
  double explained = 0.0;                ///< share of the weighted variance of F_tracker that F_sensor explains
  double correlation_time_s = 0.0;       ///< between residuals that are independent
  std::size_t used = 0;                  ///< samples compared
  struct Rival {
    double delay_s = 0.0, explained = 0.0;
  };
  std::optional<Rival> rival;  ///< the next best minimum of the cost
  bool ambiguous = false;  ///< the rival explains nearly as much, or noise cannot tell the two apart (the smaller wins)
  std::vector<double> scan_delay_s, scan_explained;  ///< the whole range
  std::vector<double> times_s;                       ///< of the samples compared:
  std::vector<Vector3d> sensor_N;                    ///< g F_sensor(t - d) + b there
};

/// Coarse scan, then Brent's method; F_sensor between its samples by cubics. A stretch of the force sensor's trace
/// longer than five of its usual steps counts as a gap and is not compared. Both in time order. Offline.
///
/// sigma: sandwich covariance A^-1 M A^-1 of (d, g, b) with Bartlett's window over neighbouring residuals.
/// Source: Newey & West, Econometrica 55 (1987).
///
/// Throws InputError, naming the cause, where the two do not overlap in time for at least 20 samples once shifted by
/// max_delay_s, the force does not change or changes so evenly that a shift looks like an offset, the forces are not
/// alike, or the best delay lies on the edge of the range.
DelayFit identify_delay(std::span<const TimedForce> tracker, std::span<const TimedForce> sensor,
                        const DelayOptions& options = {});

}  // namespace palpate
