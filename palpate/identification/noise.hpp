// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/noise_samples.hpp>
#include <string>
#include <vector>

/// What a sensor's noise is, from a recording at rest. It shows the sensor's precision, how far readings scatter about
/// their own mean. Its accuracy, how far that mean is from the truth, cannot be seen at rest.
namespace palpate {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Does the sensor stand still?
enum class Rest {
  kStill,   ///< white noise, or nearly so
  kDrifts,  ///< more of the variance is slow than white: drift, or a filter in the device
  kMoves,   ///< no sensor at rest looks like this
};

/// Scatter over windows of growing length: falls as 1 / sqrt(tau) where the noise is white, rises where it drifts.
struct AllanDeviation {
  std::vector<double> tau_s;
  std::vector<double> position_m;    ///< root mean square over the axes
  std::vector<double> rotation_rad;  ///< likewise; empty where only the position is measured
};

/// Rows and columns: position in tracker axes [m], then the rotation vector log(R_mean^T R) in sensor axes [rad].
struct RestNoise : SensorRecord {
  std::string untold;        ///< why nothing can be said; empty: all else below holds
  std::size_t outliers = 0;  ///< beyond eight spreads of the mean, left out
  std::size_t used = 0;      ///< readings that the covariance is made of
  std::size_t distinct = 0;  ///< of these, not a repetition of the one before

  Pose mean;  ///< sensor in the tracker
  /// Of one reading, drift included. Positive definite: the quantisation that a rest does not show and a floor of
  /// 0.1 um and 2 urad are on its diagonal. Of a point: the rotation's part is the floor alone.
  Matrix6d covariance = Matrix6d::Zero();
  Vector6d step = Vector6d::Zero();  ///< quantisation; zero: not seen
  double correlation_time_s = 0.0;   ///< between independent readings, of the slowest channel
  double effective_samples = 0.0;    ///< that many independent readings would tell the mean as well
  double sigma_fraction = 0.0;       ///< one standard deviation of a sigma, relative, of the slowest channel

  /// Variance of the fast and of the slow part, root mean square over the axes. The fast part is what readings forget
  /// as soon as they no longer repeat each other.
  double white_m = 0.0, slow_m = 0.0, white_rad = 0.0, slow_rad = 0.0;
  Rest rest = Rest::kStill;

  AllanDeviation allan;
  std::vector<double> times_s;       ///< of the readings used,
  std::vector<Vector6d> deviations;  ///< and how far each is from the mean

  /// Root of the largest variance along any direction.
  double worst_position_sigma_m() const;
  double worst_rotation_sigma_rad() const;
};

/// Offline: allocates; a few hundred operations a reading, more where readings hang together for long.
/// Fewer than ten distinct readings say nothing (`untold`). Never throws.
RestNoise identify_rest_noise(const SensorSamples& samples);

}  // namespace palpate
