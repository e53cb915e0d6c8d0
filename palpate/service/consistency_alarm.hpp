// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <palpate/observer/estimate.hpp>

namespace palpate::service {

/// Do the latest frames agree with what the catheter file claims? Not when their normalised innovations are together
/// above the chi-square bound, or when most of them could not be used as they are:
///
///   sum of NIS over W = 10 frames > chi2(1 - 1e-6; sum of their degrees of freedom),   or   > W / 3 frames refused
///
/// so that a field distortion, a bent shaft or a shifted sensor is said within ten frames. Bounds by Wilson and
/// Hilferty's approximation, which needs no allocation: chi2(n, p) ~ n (1 - 2 / 9n + z_p sqrt(2 / 9n))^3.
class ConsistencyAlarm {
 public:
  static constexpr std::size_t kWindow = 10;

  void take(const Estimate& estimate);
  bool alarmed() const { return alarmed_; }

 private:
  struct Frame {
    double nis = 0.0;
    int dof = 0;
    bool refused = false;  ///< the frame contradicts itself, or a sensor of it the others
  };
  std::array<Frame, kWindow> frames_{};
  std::size_t count_ = 0;
  bool alarmed_ = false;
};

}  // namespace palpate::service
