// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <palpate/simulation/virtual_tracker.hpp>
#include <tests/observer/runs.hpp>
#include <tests/sensing/virtual_setups.hpp>

/// Catheters that are not quite what their file says, drawn from the sigmas that it states.
namespace palpate::test {

/// The paper's shaft with everything uncertain that the file can name: stiffness 5 %, k1,0 3 %, base 0.3 mm and 0.3 deg
/// a axis, an electromagnetic tracker biased by 0.48 mm and 0.3 deg rms.
inline Catheter uncertain_catheter() {
  Catheter catheter = two_sensors();
  catheter.rod.sections[0].precurvature_per_m = {20.0, 0.0, 0.0};
  catheter.stiffness_sigma_fraction = 0.05;
  catheter.precurvature_sigma_per_m = {0.6, 0.0, 0.0};
  catheter.base.position_sigma_m = 0.3e-3;
  catheter.base.rotation_sigma_rad = 0.3 * kRadiansPerDegree;
  for (Sensor& sensor : catheter.sensors) {
    sensor.bias_m = 0.48e-3;
    sensor.bias_rad = 0.3 * kRadiansPerDegree;
  }
  return catheter;
}

/// What the tracker adds to the poses of a run: one error for all sensors, as neighbours share it.
struct TrackerBias {
  Vector3d position_m = Vector3d::Zero(), rotation_rad = Vector3d::Zero();  ///< base axes
};

struct Reality {
  Catheter catheter;
  TrackerBias bias;
};

/// The file's catheter, off by as much as the file admits.
inline Reality drawn_reality(const Catheter& stated, Draws& draws) {
  Reality real{stated, {}};
  Section& shaft = real.catheter.rod.sections[0];
  const double common = std::sqrt(stated.stiffness_correlation), own = std::sqrt(1.0 - stated.stiffness_correlation);
  const double shared = draws.normal(), sigma = stated.stiffness_sigma_fraction;
  const Stiffness K = shaft.stiffness_Nm2;
  for (int i = 0; i < 2; ++i)
    shaft.stiffness_Nm2(i) = K(i) * std::exp(sigma * (common * shared + own * draws.normal()));
  shaft.stiffness_Nm2(2) = K(2) * shaft.stiffness_Nm2.head<2>().sum() / K.head<2>().sum();  // Poisson's ratio
  shaft.precurvature_per_m += stated.precurvature_sigma_per_m.cwiseProduct(draws.normal3());
  const Pose error{Draws::turn(stated.base.rotation_sigma_rad * draws.normal3()),
                   stated.base.position_sigma_m * draws.normal3()};
  real.catheter.base.T_tracker_base = stated.base.T_tracker_base * error;
  const double per_axis = 1.0 / std::sqrt(3.0);
  real.bias = {per_axis * stated.sensors[0].bias_m * draws.normal3(),
               per_axis * stated.sensors[0].bias_rad * draws.normal3()};
  return real;
}

inline VirtualRecording simulate(const Reality& real, const ForceSchedule& force,
                                 const VirtualTrackerOptions& options) {
  VirtualRecording out = simulate_tracker(real.catheter, force, options);
  const Matrix3d R = real.catheter.base.T_tracker_base.R;
  for (TrackerFrame& frame : out.frames)
    for (SensorReading& reading : frame.readings) {
      const Matrix3d turned = Draws::turn(R * real.bias.rotation_rad) * rotation_of(reading);
      reading = reading_of({turned, reading.position_m + R * real.bias.position_m});
    }
  return out;
}

/// Share of estimates whose 95 % interval holds the truth, a tip axis.
struct Coverage {
  Vector3d inside = Vector3d::Zero();
  double count = 0.0;

  void add(const Vector3d& error_N, const Matrix3d& covariance_N2) {
    constexpr double k95 = 1.959964;
    const Eigen::Array3d sigma = covariance_N2.diagonal().array().sqrt();
    inside += (error_N.array().abs() <= k95 * sigma).cast<double>().matrix();
    count += 1.0;
  }
  Vector3d percent() const { return 100.0 * inside / count; }
};

}  // namespace palpate::test
