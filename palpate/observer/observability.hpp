// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <palpate/math/rotation.hpp>
#include <string>
#include <string_view>

/// What the force's uncertainty is made of, and what the shape cannot tell.
namespace palpate {

/// Where the uncertainty of a force comes from.
enum class UncertaintySource : std::uint8_t {
  kNoise,         ///< white noise of the sensors, and a force that moves between frames
  kBias,          ///< slowly varying accuracy error of the tracker
  kStiffness,     ///< of the shaft
  kPrecurvature,  ///< of the unloaded shaft
  kBase,          ///< registration of the clamp
  kMounting,      ///< of the sensors
  kTendon,        ///< its moment
};
inline constexpr std::size_t kUncertaintySources = 7;

/// "noise", "bias", ...: words of summaries and of JSON keys.
std::string_view describe(UncertaintySource source);

/// Share of each source in the force's variance, tip axes: the squares add up to the diagonal of the covariance.
using SigmaBudget = std::array<Vector3d, kUncertaintySources>;

/// `SigmaBudget{}` would leave its numbers as they lie in memory: Eigen's vectors do not start at zero.
inline SigmaBudget zero_budget() {
  SigmaBudget budget;
  budget.fill(Vector3d::Zero());
  return budget;
}

/// The shaft as it is believed to be, of its first flexible section, and how sure that is. What is not estimated keeps
/// value and sigma of the catheter file.
struct ShaftEstimate {
  Vector3d stiffness_Nm2 = Vector3d::Zero(), stiffness_sigma_Nm2 = Vector3d::Zero();  ///< EI1, EI2, GJ
  Vector3d precurvature_per_m = Vector3d::Zero(), precurvature_sigma_per_m = Vector3d::Zero();
};

/// What one frame alone, all else being uncertain as the catheter file says, tells about force and estimated
/// parameters.
struct Observability {
  /// Eigenvector of the least eigenvalue of the information matrix, whitened by the prior sigmas: its force part [N]
  /// (tip axes) and its part in (log EI1, log EI2, log GJ) and (k1,0, k2,0) [1/m]; one prior sigma long.
  Vector3d weakest_force_N = Vector3d::Zero(), weakest_log_stiffness = Vector3d::Zero(),
           weakest_precurvature_per_m = Vector3d::Zero();
  double weakest_sigmas =
      0.0;  ///< sigma of that direction by the frame alone, in prior sigmas; inf: the frame is blind

  bool axial_force_hidden = false;           ///< the frame says little about the force along d3 ...
  bool shaft_straight = false;               ///< ... because there is hardly a bend
  bool lateral_force_hidden = false;         ///< nor about the force across
  bool stiffness_rests_on_prior = false;     ///< nothing with newtons in it has narrowed its scale
  bool precurvature_rests_on_prior = false;  ///< estimated, but no wiser than the file
  double stiffness_scale_sigma = 0.0;        ///< of the mean of log EI1, log EI2
  double stiffness_scale_prior_sigma = 0.0;

  bool all_observable() const {
    return !(axial_force_hidden || lateral_force_hidden || stiffness_rests_on_prior || precurvature_rests_on_prior);
  }
};

/// "axial force not observable: shaft is straight; stiffness scale rests on the prior"; "all observable" where it is.
std::string describe(const Observability& observability);

/// Region that holds the force with probability `share`: semi-axes [N] along the columns of `axes`, largest first.
struct ForceEllipsoid {
  Vector3d semi_axes_N = Vector3d::Zero();
  Matrix3d axes = Matrix3d::Identity();
};
ForceEllipsoid force_ellipsoid(const Matrix3d& covariance_N2, double share = 0.95);

}  // namespace palpate
