// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <palpate/identification/noise_samples.hpp>
#include <string>
#include <vector>

/// What a sensor's noise is, from a recording in which it moves smoothly: the innovations of a Kalman filter tell.
namespace palpate {

/// One scalar channel z(t) = x(t) + r w with white w. White noise q e drives the second derivative of the motion x
/// (order 2, constant velocity) or the third (order 3, constant acceleration), whichever makes the innovations
/// likelier.
struct MovingChannel {
  int order = 2;
  double sigma = 0.0;           ///< r, of the white measurement noise [m or rad]
  double sigma_fraction = 0.0;  ///< one standard deviation of r, relative, from the likelihood's curvature
  double drive = 0.0;           ///< q, [m or rad] / s^(order - 1/2)
  double log_likelihood = 0.0;
  double nis = 0.0;                   ///< mean squared innovation over its variance; 1 where the filter is true
  double outside_95 = 0.0;            ///< share of innovations beyond 1.96 sigma; 0.05 where the filter is true
  double lag_one = 0.0;               ///< autocorrelation of neighbouring innovations; 0 where the filter is true
  double correlation = 0.0;           ///< of innovations one to ten apart, root mean square,
  double correlation_if_white = 0.0;  ///< and what white ones show by chance
  std::size_t outliers = 0;           ///< innovations beyond 5 sigma, passed over
  std::vector<double> innovations;    ///< in sigmas; outliers are not in it
  std::vector<double> times_s;        ///< of the innovations

  /// The filter follows the motion well enough for r to be that of the sensor, within about a tenth. The limits are
  /// found by trial, on sinusoids and on a catheter that follows a beating wall (tests/identification): what order 3
  /// leaves correlated is slow and moves r less than what order 2 does.
  bool holds() const {
    const double most = (order == 3 ? 0.17 : 0.1) + correlation_if_white;
    return correlation < most && outside_95 > 0.03 && outside_95 < 0.09 && sigma_fraction < 0.2;
  }
};

struct MovingNoise : SensorRecord {
  std::string untold;        ///< why nothing can be said; empty: all else below holds
  std::size_t used = 0;      ///< readings that are no repetition
  std::size_t repeated = 0;  ///< exact repetitions of the one before, passed over
  /// Position along tracker axes [m]; then the sums of log(R_(k-1)^T R_k), the turn about the sensor's axes [rad].
  std::array<MovingChannel, 6> channels;

  bool holds() const;
};

/// Maximises the likelihood of the innovations over log q and log r, channel by channel (NLopt, Nelder-Mead from the
/// best of a robust scan over the ratio of the two); times may be irregular. Fewer than 30 distinct readings say
/// nothing (`untold`). Offline: about 200 filter passes a channel.
/// Source: Schweppe, Evaluation of likelihood functions for Gaussian signals (1965); Bar-Shalom, Li, Kirubarajan,
/// Estimation with Applications to Tracking and Navigation (2001), section 6.2.2.
MovingNoise identify_moving_noise(const SensorSamples& samples);

}  // namespace palpate
