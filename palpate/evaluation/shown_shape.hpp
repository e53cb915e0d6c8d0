// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/estimate_csv.hpp>
#include <palpate/rod/base_loads.hpp>
#include <palpate/sensing/catheter.hpp>
#include <palpate/sensing/tracker_frame.hpp>

namespace palpate {

/// The shaft as an estimate says it lies, for those who look at it: report, dashboard, 3D Slicer.
class ShownShape {
 public:
  /// `points` from the clamp to the end, equally spaced; behind them one at each sensor.
  ShownShape(const Catheter& catheter, int points);

  /// Under the estimated force, with the shaft as it was believed to be and what the frame says of tendon and handle.
  /// One rod solution, or a few where the shaft's weight counts. Valid until the next call.
  const RodSolution<3>& solve(const TrackerFrame& frame, const EstimateRow& row);

 private:
  TipLoad load(const TrackerFrame& frame, const EstimateRow& row) const;

  Section shaft_;
  TendonModel tendon_model_;
  RodSolver solver_;
  WeightWorkspace<3> workspace_;
  RodSolution<3> solution_;
};

}  // namespace palpate
