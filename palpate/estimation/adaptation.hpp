// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <palpate/math/linearization.hpp>
#include <vector>

/// Covariance matching over a window (paper, section 3.3.2) with the corrections argued in docs/theory/estimation.md.
namespace palpate {

/// Adapts the measurement noise R, channel by channel, from post-fit residuals r+ of the last M updates:
///
///   R_i = cov_M(r+_i) + mean_M((J P+ J^T)_ii)                               (19), residual r+ = y (-) h(x+)
///
/// The process noise is left alone: Q and R together are not identifiable. A few samples say little, so R_i / R_i,0
/// is shrunk towards 1 by the weight of `kPriorSamples` and kept within limits: R stays positive definite.
class NoiseAdaptation {
 public:
  static constexpr double kPriorSamples = 10.0;
  static constexpr double kLeastRatio = 0.1, kLargestRatio = 1e4;

  struct Limits {
    double prior_samples = kPriorSamples;                             ///< weight of R0; 0: the window alone
    double least_ratio = kLeastRatio, largest_ratio = kLargestRatio;  ///< of R_i / R_i,0
  };

  /// Allocates the window once. window >= 2.
  NoiseAdaptation(int channels, int window) : NoiseAdaptation(channels, window, Limits{}) {}
  NoiseAdaptation(int channels, int window, const Limits& limits);

  /// Scales nominal noise R0 to D R0 D, D_ii = sqrt(ratio of the row's channel).
  void apply(const Channels& channels, ResidualMatrix& noise) const;

  /// One accepted update: its nominal noise, and residual, Jacobian and covariance after it.
  void observe(const Channels& channels, const ResidualMatrix& nominal_noise, const Linearization& at,
               const StateMatrix& posterior_covariance);

  double ratio(int channel) const { return channel_[static_cast<std::size_t>(channel)].ratio; }

 private:
  struct Channel {
    /// Ring buffers of r / sqrt(R0) and (J P+ J^T) / R0. Eigen's, for it sums from the first aligned address on: over a
    /// std::vector, the last bits would depend on where the heap has put it.
    Eigen::ArrayXd residual, projected;
    int count = 0, next = 0;
    double ratio = 1.0;
  };
  std::vector<Channel> channel_;
  Limits limits_;
};

}  // namespace palpate
