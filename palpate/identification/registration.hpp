// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/mean_poses.hpp>
#include <palpate/sensing/catheter.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <span>
#include <string>
#include <vector>

/// Where the clamp stands, and how the sensors sit on the shaft, from the poses of the unloaded shaft at several knob
/// positions, that is with several bends:
///
///   arg min  r^T R^-1 r + prior,   r_ij = T_ref_sensor,ij (measured)  (-)  T_ref_base T_base_local(s_i; u_j) T_mount,i
///
/// over the base pose T_ref_base (6), the bend k1, k2 of every knob position j, the twist tau that they share, and, if
/// asked for, the mounting of every sensor (6 each). T_base_local is the rod under its own weight and no tip force. The
/// reference frame is the tracker's, or that of the base sensor where the base is tracked: then the sensor's mounting
/// in the clamp frame, T_ref_base^-1, is found.
///
/// Found from any start: what the catheter file says of the base is not used.
namespace palpate {

/// The shaft at rest, unloaded, at one position of the knob.
struct KnobPosition {
  std::string name = {};
  std::vector<MeanPose> poses = {};  ///< T_ref_sensor (in the field T_base_sensor), in the order of Catheter::sensors
};

/// Mean poses in the reference frame over from_s <= time <= to_s: in the tracker's frame, whatever the catheter file
/// says of the base; in the base sensor's where the base is tracked.
std::vector<MeanPose> mean_reference_poses(const Catheter& catheter, std::span<const TrackerFrame> frames,
                                           double from_s, double to_s);

/// A sensor that was not at rest.
struct SensorDrift {
  int sensor = 0;
  double moved_m = 0.0;  ///< from the mean of the first half of the frames to that of the second
};

/// The sensors that moved between from_s and to_s by more than their noise explains. Needs four frames.
std::vector<SensorDrift> find_drift(const Catheter& catheter, std::span<const TrackerFrame> frames, double from_s,
                                    double to_s);

struct RegistrationOptions {
  bool mounting = false;             ///< the mounting of the sensors is unknown, too
  double mount_sigma_m = 1e-3;       ///< per axis, of the stated mounting, where Sensor::mount_sigma_m is 0; > 0
  double mount_sigma_rad = 0.08727;  ///< per axis, of the stated mounting: 5 deg; > 0

  /// Throws InputError naming the field, its value and the range.
  void validate() const;
};

struct Registration {
  bool converged = false;
  Catheter catheter =
      {};  ///< with the base (where tracked: the base sensor's mounting) and mountings found, and sigmas
  Pose T_reference_base = {};
  /// Of position [m], then rotation [rad] of the clamp, in its own axes. Noise averages out over the frames, the
  /// tracker's bias does not: both are in it. Catheter::base has the largest axis of each.
  Eigen::Matrix<double, 6, 6> base_covariance = Eigen::Matrix<double, 6, 6>::Zero();

  struct Residual {
    bool seen = false;
    int frames = 0;
    Vector3d position_m = Vector3d::Zero();    ///< measured - fitted, base axes
    Vector3d rotation_rad = Vector3d::Zero();  ///< measured - fitted, sensor axes; 0 along what is not measured
    double sigma_m = 0.0, sigma_rad = 0.0;     ///< of the mean as stated, per axis: white noise and bias
    double chi_square = 0.0;                   ///< against its own noise
  };
  struct Position {
    std::string name = {};
    Vector3d precurvature_per_m = Vector3d::Zero();  ///< k1, k2, tau of the first flexible section
    Vector3d sigma_per_m = Vector3d::Zero();
    std::vector<Residual> residuals = {};  ///< in the order of Catheter::sensors
  };
  std::vector<Position> positions = {};

  struct Mounting {
    Pose T_local_sensor = {};
    Vector3d sigma_m = Vector3d::Zero();    ///< local axes
    Vector3d sigma_rad = Vector3d::Zero();  ///< local axes
  };
  std::vector<Mounting> mountings = {};  ///< as found, or as stated with sigma 0; in the order of Catheter::sensors

  double position_rms_m = 0.0, rotation_rms_rad = 0.0;  ///< of the residuals, in 3-D
  double chi_square = 0.0;  ///< against the stated noise, bias and priors; degrees of freedom beside it
  int degrees_of_freedom = 0;
  /// All sigmas are larger by this than the stated noise makes them: 1 where chi-square is as it should be.
  double sigma_inflation = 1.0;
  int starts = 0, iterations = 0;
  std::vector<std::string> warnings = {};  ///< what a user must know, one line each
};

/// Searches from many starts, so that the true base may be anywhere. Offline: allocates; tens of milliseconds with
/// sensors of six degrees of freedom, seconds with points alone.
///
/// What the poses cannot tell is fixed, and said in a warning: with unknown mountings a common roll of base and sensors
/// (the first 6-DOF sensor keeps its roll); without any 6-DOF sensor the roll of the base (the shaft is then taken to
/// bend about d1, to the side of the stated k1: k2 has the stated value, with its sigma).
/// Throws InputError, naming the cause, on fewer measured numbers than unknowns, and where a number stays unknown all
/// the same.
Registration identify_registration(const Catheter& catheter, std::span<const KnobPosition> positions,
                                   const RegistrationOptions& options = {});

}  // namespace palpate
