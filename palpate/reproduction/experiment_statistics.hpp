// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/math/rotation.hpp>
#include <span>

/// MEAN and STD as Table 7 gives them. The paper does not say over what; here: over time within a repeat, then over
/// repeats.
namespace palpate::reproduction {

/// One repeat: error = estimate - truth, tip axes.
struct ErrorStatistics {
  Vector3d mean_N = Vector3d::Zero();   ///< over time
  Vector3d sigma_N = Vector3d::Zero();  ///< standard deviation over time (divisor n - 1)
};

/// Frames before `first` are left out. Preconditions: equal sizes, at least two frames left.
ErrorStatistics error_statistics(std::span<const Vector3d> estimate_N, std::span<const Vector3d> truth_N,
                                 std::size_t first);

/// Share of the frames whose error lies within 1.96 sigma, axis by axis; 0.95 where the sigmas are true.
Vector3d inside_95(std::span<const Vector3d> estimate_N, std::span<const Vector3d> truth_N,
                   std::span<const Vector3d> sigma_N, std::size_t first);

/// All repeats of an experiment.
struct RepeatStatistics {
  Vector3d mean_N = Vector3d::Zero();         ///< MEAN: average of |mean over time|
  Vector3d mean_spread_N = Vector3d::Zero();  ///< standard deviation of |mean over time| between repeats
  Vector3d sigma_N = Vector3d::Zero();        ///< STD: average of the standard deviation over time
  Vector3d sigma_spread_N = Vector3d::Zero();
};

/// Precondition: at least two repeats.
RepeatStatistics over_repeats(std::span<const ErrorStatistics> repeats);

}  // namespace palpate::reproduction
