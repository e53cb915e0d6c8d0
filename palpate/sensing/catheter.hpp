// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <palpate/math/pose.hpp>
#include <palpate/math/units.hpp>
#include <palpate/rod/rod.hpp>
#include <palpate/sensing/tendon_map.hpp>
#include <string>
#include <vector>

namespace palpate {

/// What a tracked sensor measures.
enum class SensorKind {
  kPose,      ///< 6 degrees of freedom
  kPose5,     ///< no roll about the sensor's z axis
  kPosition,  ///< a point
};

/// A sensor fixed to the shaft, or to the base.
struct Sensor {
  std::string name;
  SensorKind kind = SensorKind::kPose;
  double arc_length_m = 0.0;   ///< up to the flexible length plus the rigid tip; unused for the base sensor
  Pose T_local_sensor;         ///< mounting: sensor axes and origin in the local frame (d1, d2, d3)
  double mount_sigma_m = 0.0;  ///< of the mounting position, per axis
  Vector3d noise_m = Vector3d::Constant(0.28e-3);  ///< white noise of the position, along the base axes
  double noise_rad = 0.17 * kRadiansPerDegree;     ///< white noise of the orientation, per axis
  double bias_m = 0.0;    ///< slowly varying accuracy error, rms in 3-D, shared by neighbours (Catheter::bias_length_m)
  double bias_rad = 0.0;  ///< of the orientation, rms in 3-D, likewise
  std::optional<Pose>
      T_tracker_base;                ///< the clamp in the frame of this sensor's own tracker or image; else the base's
  double delay_s = 0.0;              ///< its time stamps are later than the event by this much
  std::vector<std::string> markers;  ///< optical capture: midpoint (position) or triad (pose) of these
};

enum class TendonModel {
  kCouple,     ///< moment constant in local components: turns with each section
  kEndMoment,  ///< moment constant in tip components, at the tip
};

struct Tendon {
  bool present = false;
  TendonModel model = TendonModel::kCouple;
  double offset_m = 0.0;  ///< tendon to centreline; moment = tension * offset; 0: not given
  double moment_sigma_fraction = 0.0;
};

/// Where the clamp frame stands in the tracker's frame.
struct BaseRegistration {
  Pose T_tracker_base;
  double position_sigma_m = 0.0;  ///< per axis
  double rotation_sigma_rad = 0.0;
  /// Of position [m] and rotation [rad] in base axes, where more is known than the two sigmas tell (a tare).
  std::optional<Eigen::Matrix<double, 6, 6>> covariance;
  bool tracked = false;  ///< a base sensor gives the pose in every frame instead
  Sensor sensor;         ///< the base sensor (T_local_sensor: its mounting in the clamp frame)
};

/// One catheter in one setup: the shaft, what watches it, and how well each number is known (one sigma).
struct Catheter {
  std::string name;
  Rod rod;
  Tendon tendon;
  TendonMap tendon_map;
  std::vector<Sensor> sensors;  ///< on the shaft; the order of readings in a TrackerFrame
  BaseRegistration base;
  double stiffness_sigma_fraction = 0.0;  ///< of each of EI1, EI2, GJ
  double stiffness_correlation = 0.9;     ///< of the three errors with each other: most of them is a common scale
  Vector3d precurvature_sigma_per_m = Vector3d::Zero();
  double bias_length_m = 0.05;  ///< the tracker's accuracy error is alike over this distance
  double bias_memory_s = 60.0;  ///< and over this time

  /// The clamp in the frame in which `sensor` is measured: its own registration, or the fixed one of the base.
  const Pose& T_tracker_base(const Sensor& sensor) const {
    return sensor.T_tracker_base ? *sensor.T_tracker_base : base.T_tracker_base;
  }

  /// Of the first flexible section, (k1,0, k2,0, tau0); without one that of the first.
  const Vector3d& precurvature_per_m() const;

  /// Throws InputError naming the sensor or parameter, its value and the range.
  void validate() const;
};

/// The same catheter driven through its tendon map, as frames with a BendReading are: the map's sigma is that of the
/// precurvature, and the tendon's moment, which would bend the shaft a second time, is out of use. Where a tendon map
/// is absent nothing changes.
Catheter driven_by_map(Catheter catheter);

/// Most sensors on one shaft: bounds every fixed-capacity matrix of the estimator.
inline constexpr int kMaxSensors = 8;

}  // namespace palpate
