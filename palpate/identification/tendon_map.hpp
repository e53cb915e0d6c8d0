// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/sensing/tendon_map.hpp>
#include <span>
#include <string>
#include <vector>

namespace palpate {

/// Precurvature of the unloaded shaft with the handle at rest.
struct HandleSample {
  double position = 0.0;  ///< rad, m or N
  bool release = false;   ///< reached while the position fell; otherwise while it rose
  Eigen::Vector2d precurvature_per_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d sigma_per_m = Eigen::Vector2d::Zero();  ///< of the measurement; 0: not stated
};

struct TendonMapFit {
  TendonMap map;
  /// One standard deviation of what the map says at its positions: of the curve, and of the shaft about it.
  std::vector<Eigen::Vector2d> pull_sigma_per_m, release_sigma_per_m;
  std::vector<Eigen::Vector2d> residual_per_m;  ///< of each sample: measured - curve
  /// Of the samples about the curves; degrees of freedom of k1,0 beside it.
  Eigen::Vector2d scatter_per_m = Eigen::Vector2d::Zero();
  double degrees_of_freedom = 0.0;
  int pulls = 0, releases = 0;
  double mean_width_per_m = 0.0, largest_width_per_m = 0.0;  ///< of the hysteresis, in k1,0
  double dead_zone = 0.0;  ///< by how much the handle turns back before the bend does, on average: rad, m or N
  std::vector<std::string> warnings;
};

/// Smooth monotone branches through samples of one loop over the whole range, and their sigma. Each branch is a cubic
/// curve through values at equal steps (as TendonPlay reads it), fitted to the samples with a penalty on its second
/// differences that generalised cross-validation chooses (Craven and Wahba 1979); then made monotone in k1,0 by pooling
/// neighbours, and the branches are parted where noise lets them cross.
///
/// Map's sigma^2 = scatter of the shaft + variance of the curve. Of the samples' scatter, what their own stated sigmas
/// explain is not the shaft's. `common_error`: those sigmas are an error that all samples share, as that of the clamp
/// is; it then explains no scatter, and adds to the map's sigma whole.
///
/// Throws InputError, naming the cause, on fewer than three samples or positions a branch, and where the release branch
/// is the less bent one. No release sample: one branch for both, and a warning. Offline: allocates.
TendonMapFit fit_tendon_map(std::span<const HandleSample> samples, TendonInput input, bool common_error = false);

}  // namespace palpate
