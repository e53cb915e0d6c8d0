// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <palpate/identification/mean_poses.hpp>
#include <string>
#include <vector>

/// Curvature of the unloaded shaft (paper, section 5.1): the constant-curvature arc that fits its markers or sensors
/// best. One model for both, the catheter's rod under no force:
///
///   r_i(k1,0, k2,0, tau0, clamp) = measured_i (-) rod_i,   minimise  sum |r_i / sigma_i|^2 + what is stated of the
///   clamp
///
/// with own weight where the catheter has it. Levenberg-Marquardt (ceres::TinySolver) with exact derivatives.
namespace palpate {

/// A marker on the centre line. A NaN component was not measured, as in a picture from one side.
struct ShaftPoint {
  double arc_length_m = 0.0;
  Vector3d position_m = Vector3d::Zero();
};

/// What is known of the clamp, in the frame of points and poses.
enum class ClampKnowledge {
  kExact,   ///< the frame is the base frame
  kStated,  ///< it is, to Catheter::base's sigmas
  kFree,    ///< any frame. From points alone the bending plane is then not told: it stays as the catheter has it
};

struct ArcData {
  std::vector<ShaftPoint> points;
  double point_sigma_m = 0.0;   ///< of each component; 0: told by the residuals
  std::vector<MeanPose> poses;  ///< empty, or one for each of Catheter::sensors
};

struct ArcFit {
  bool converged = false;
  Vector3d precurvature_per_m = Vector3d::Zero();  ///< k1,0, k2,0, tau0
  Matrix3d covariance = Matrix3d::Zero();          ///< of these, 1/m^2
  std::array<bool, 3> told{};                      ///< by the data; otherwise the catheter's value was kept
  Pose T_frame_base;                               ///< the clamp as found

  struct Place {
    double arc_length_m = 0.0;
    Vector3d measured_m, fitted_m;  ///< in the frame of the data; a component that was not measured is NaN
    Vector3d turn_rad;              ///< of a pose: measured against fitted, sensor axes; otherwise NaN
  };
  std::vector<Place> places;  ///< points, then poses
  double rms_m = 0.0;         ///< over the measured components of position
  double chi_square = 0.0;    ///< of all that is weighed; about degrees_of_freedom where the sigmas are true
  int degrees_of_freedom = 0;
  double point_sigma_m = 0.0;    ///< stated, or told by the residuals
  double interval_factor = 0.0;  ///< half a 95 % interval over a sigma: Student's t where the residuals tell the noise

  /// k1, k2 at the end of the shaft less those at the clamp, were the curvature to change linearly; and how probable so
  /// much is by noise alone.
  Eigen::Vector2d change_along_per_m = Eigen::Vector2d::Zero();
  double change_probability = 1.0;
  bool doubtful = false;              ///< not converged, or farther off than the stated sigmas allow
  std::vector<std::string> warnings;  ///< one line each
};

/// The arc replaces the precurvature of all flexible sections, which must be alike in it. tau0 is fitted where a sensor
/// tells its whole orientation; points leave it as it is, known to the catheter's sigma.
/// Throws InputError, naming the cause, on fewer measured numbers than unknowns, an arc length outside the shaft,
/// points whose distances contradict their arc lengths, sections of different precurvature. Offline: allocates; about
/// 1 ms.
ArcFit fit_arc(const Catheter& catheter, const ArcData& data, ClampKnowledge clamp = ClampKnowledge::kExact);

/// Centre line of the fitted shaft, in the frame of the data, at `count` equal steps from clamp to end.
std::vector<Vector3d> fitted_curve(const Catheter& catheter, const ArcFit& fit, int count = 50);

}  // namespace palpate
