// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

namespace palpate {

/// What the tracker says about one sensor at one time, unchecked: any number may be NaN, any quaternion broken.
struct SensorReading {
  enum class Status : std::uint8_t {
    kMissing,  ///< the tracker does not see it
    kOk,
    kAbsent,  ///< the frame does not speak of it: another tracker's, or one with times of its own
  };

  Status status = Status::kMissing;
  bool has_orientation = false;                               ///< false: a point only
  Eigen::Vector4d quaternion_wxyz = Eigen::Vector4d::Zero();  ///< sensor to tracker, as received
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();       ///< sensor origin in the tracker's frame
  double error_m = std::numeric_limits<double>::quiet_NaN();  ///< the device's own quality figure, if any
};

/// Moment that the tendon exerts on the shaft, about d1 and d2.
struct TendonReading {
  bool present = false;
  Eigen::Vector2d moment_Nm = Eigen::Vector2d::Zero();
  double sigma_Nm = 0.0;
};

/// What the handle makes of the unloaded shaft's curvature (TendonPlay). It carries no newtons: however stiff the shaft
/// is, it bends so far.
struct BendReading {
  bool present = false;
  bool inside = true;                                      ///< false: beyond the tendon map's ends
  Eigen::Vector2d change_per_m = Eigen::Vector2d::Zero();  ///< of k1,0, k2,0 over the catheter's, all sections alike
  Eigen::Vector2d sigma_per_m = Eigen::Vector2d::Zero();   ///< of what k1,0, k2,0 thereby are; 0: the catheter's
};

/// An episode in which the load is known: the tip hangs free, or a dead weight pulls at it.
struct KnownLoad {
  bool present = false;
  bool in_base = false;  ///< base components, otherwise tip components
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
  double sigma_N = 0.0;  ///< along each axis
};

/// One instant of a tracker, or of several. `readings` follow Catheter::sensors; the base sensor, if tracked, comes
/// last.
struct TrackerFrame {
  double time_s = 0.0;
  std::int64_t number = 0;
  std::vector<SensorReading> readings = {};
  TendonReading tendon = {};
  BendReading bend = {};
  KnownLoad known_load = {};
};

}  // namespace palpate
