// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <palpate/identification/registration.hpp>
#include <palpate/rod/base_loads.hpp>
#include <palpate/sensing/sensor_model.hpp>

namespace palpate {

/// All unknowns of a registration, as they stand.
struct RegistrationState {
  Pose T_reference_base;
  double twist_change_per_m = 0.0;                 ///< all changes: against the catheter file's precurvature
  std::vector<Eigen::Vector2d> bend_change_per_m;  ///< (k1, k2), a knob position
  std::vector<Pose> T_local_sensor;                ///< mountings
};

/// One sensor at one knob position.
struct RegistrationReading {
  int position = 0, sensor = 0;
  int first_row = 0, rows = 0;
  const MeanPose* mean = nullptr;
};

/// Residuals of all readings and their derivatives by x, the step away from a state:
///
///   x = (rho, theta | tau | k1, k2 of each position | c, phi of each sensor, where mountings are unknown),
///   T_ref_base -> T_ref_base (exp(theta), rho),   T_mount -> (exp(phi) R_mount, p_mount + c).
class RegistrationModel {
 public:
  RegistrationModel(const Catheter& catheter, std::span<const KnobPosition> positions, bool mounting);

  const Catheter& catheter() const { return catheter_; }
  std::span<const RegistrationReading> readings() const { return readings_; }
  int positions() const { return positions_; }
  int rows() const { return rows_; }
  int unknowns() const { return mounting_ ? mount_column(sensors()) : bend_column(positions_); }
  bool mounting() const { return mounting_; }
  int sensors() const { return static_cast<int>(catheter_.sensors.size()); }
  static constexpr int kTwistColumn = 6;
  static int bend_column(int position) { return 7 + 2 * position; }
  int mount_column(int sensor) const { return bend_column(positions_) + 6 * sensor; }

  /// The stated mountings, no change of precurvature, the base at the reference frame's origin.
  RegistrationState stated() const;
  RegistrationState step(const RegistrationState& from, const Eigen::VectorXd& x) const;

  struct Evaluation {
    Eigen::VectorXd residual;  ///< measured - predicted; position [m] in reference axes, then orientation [rad]
    Eigen::MatrixXd jacobian;  ///< of the prediction: r(x + dx) = r(x) - J dx
  };
  /// False where the shaft has no equilibrium under its own weight. Costs one rod with sensitivities a position.
  bool evaluate(const RegistrationState& from, const Eigen::VectorXd& x, Evaluation& at);

  /// Sensor poses of the shaft with this change of precurvature in the base frame, mountings as in `state`; empty where
  /// there is no equilibrium.
  std::vector<Pose> unloaded_shape(const Vector3d& precurvature_change_per_m, const RegistrationState& state);

 private:
  bool solve(const Vector3d& precurvature_change_per_m);
  void add_reading(const RegistrationReading& reading, const RegistrationState& from, const RegistrationState& to,
                   const Eigen::VectorXd& x, Evaluation& at) const;

  Catheter catheter_;
  bool mounting_;
  int positions_ = 0, rows_ = 0;
  std::vector<RegistrationReading> readings_;
  RodSolver solver_;
  RodSolution<3> shape_;
  WeightWorkspace<3> workspace_;
};

}  // namespace palpate
