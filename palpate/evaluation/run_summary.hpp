// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <palpate/evaluation/uncertainty_summary.hpp>
#include <palpate/observer/estimate.hpp>
#include <vector>

namespace palpate {

/// What happened over a run of the observer: every frame and every reading is accounted for.
struct RunSummary {
  std::size_t frames = 0;
  double first_time_s = 0.0, last_time_s = 0.0;
  std::array<std::size_t, kEstimateStatuses> by_status{};
  /// kNone: readings that were used or usable; kAbsent: none at all, for the frame does not speak of the sensor.
  std::array<std::size_t, kRejections> readings_by_reason{};
  std::size_t time_stood_still = 0, time_stepped_back = 0, time_not_finite = 0, clock_resynchronised = 0;

  Vector3d mean_force_tip_N = Vector3d::Zero();  ///< over updated frames
  Vector3d median_sigma_N = Vector3d::Zero();    ///< over updated frames
  Vector3d last_force_tip_N = Vector3d::Zero(), last_force_base_N = Vector3d::Zero(), last_sigma_N = Vector3d::Zero();
  double largest_force_N = 0.0;
  double mean_nis_per_dof = 0.0;                           ///< 1 where prediction and noise are as claimed
  double mean_rho_paper = 0.0, mean_rho_normalised = 0.0;  ///< convergence index, section 4.2 of the paper
  double median_evaluations = 0.0;
  int most_evaluations = 0;
  UncertaintySummary uncertainty;
};

/// Collects a summary frame by frame; memory grows by a few numbers a frame (for the medians).
class RunSummaryBuilder {
 public:
  /// `readings`: entries of `estimate.rejections` that are in use (sensors, and a tracked base).
  void add(const Estimate& estimate, std::size_t readings);
  RunSummary finish();

 private:
  RunSummary summary_;
  std::size_t updated_ = 0;
  std::vector<float> evaluations_;
  std::array<std::vector<float>, 3> sigmas_;
  UncertaintySummaryBuilder uncertainty_;
};

}  // namespace palpate
