// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <palpate/sensing/catheter.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <palpate/simulation/bias_field.hpp>
#include <palpate/simulation/scenario.hpp>
#include <random>
#include <span>
#include <vector>

namespace palpate {

/// What a tracker reports of poses that are known. With b, n the accuracy error and the noise, all in the tracker:
///
///   t = p + b(p) + R_tracker_base n_p,   R = exp(b_R(p)) R_tracker_sensor exp(n_R)
///
/// A 5-DOF sensor knows its axis alone: it reports the shortest turn from the tracker's z to it, behind a roll of its
/// own. Noise, faults and stamps are drawn one apart from the other: a fault more changes no noise.
class ErrorTracker {
 public:
  /// Precondition: both are valid.
  ErrorTracker(const Catheter& catheter, const TrackerErrors& errors, std::uint64_t seed);

  /// Readings as Catheter::sensors, a tracked base last. `T_base_local`: rod frames at the sensors; `T_tracker_base`:
  /// where the clamp is now. A sensor with a registration of its own sees the clamp move as the base's tracker does.
  std::vector<SensorReading> read(std::span<const Pose> T_base_local, const Pose& T_tracker_base);

  bool drops_frame();           ///< drawn once a frame
  double stamp(double time_s);  ///< time_s + latency + jitter; later than the one before, whatever the jitter

 private:
  SensorReading read_sensor(const Sensor& sensor, const Pose& T_tracker_sensor, const Matrix3d& R_tracker_base,
                            double roll_rad);
  void quantise(SensorReading& reading) const;
  void strike(SensorReading& reading);
  Vector3d noise(double sigma);

  std::vector<Sensor> sensors_;  ///< the base's, if tracked, last
  std::vector<double> roll_rad_;
  bool base_tracked_;
  Pose T_tracker_base_at_rest_;
  TrackerErrors errors_;
  BiasField bias_m_, bias_rad_;
  std::mt19937_64 noise_engine_, fault_engine_, drop_engine_, stamp_engine_;
  std::normal_distribution<double> noise_normal_, stamp_normal_;
  double last_stamp_s_;
};

}  // namespace palpate
