// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <palpate/observer/estimate.hpp>
#include <vector>

namespace palpate {

/// What one frame alone tells least about, one prior sigma long (Observability).
struct WeakestDirection {
  Vector3d force_N = Vector3d::Zero(), log_stiffness = Vector3d::Zero(), precurvature_per_m = Vector3d::Zero();
  double prior_sigmas = 0.0;  ///< to which the frame knows it; inf: not at all; 0: no frame was used
};

/// Used frames in which something could not be observed.
struct HiddenFrames {
  std::size_t axial_force = 0;
  std::size_t axial_force_straight = 0;  ///< of these, because the shaft was straight
  std::size_t lateral_force = 0;
  std::size_t stiffness_scale = 0, precurvature = 0;  ///< rests on the prior
};

/// What the sigmas of a run are made of, and what the run cannot tell.
struct UncertaintySummary {
  std::size_t frames_used = 0;
  SigmaBudget median_sigma_by_source_N = zero_budget();  ///< over used frames, axis by axis
  WeakestDirection weakest;                              ///< of the used frame that is the median by its prior_sigmas
  HiddenFrames hidden;
  Matrix3d last_covariance_tip_N2 = Matrix3d::Zero();  ///< the last frame's, used or not, as all that follows
  ShaftEstimate last_shaft;
  Observability last_observability;
};

/// Collects it frame by frame. Memory: four bytes a used frame for each source that is not zero and each axis, and 40
/// for the weakest direction.
class UncertaintySummaryBuilder {
 public:
  void add(const Estimate& estimate);
  UncertaintySummary finish();

 private:
  /// Median of numbers that are mostly zero or mostly not.
  class Median {
   public:
    void add(double value);
    double finish();

   private:
    std::size_t zeros_ = 0;
    std::vector<float> positive_;
  };
  struct Weakest {
    float prior_sigmas;
    std::array<float, 9> direction;
  };

  void count_hidden(const Observability& observability);
  WeakestDirection median_weakest();

  UncertaintySummary summary_;
  std::array<std::array<Median, 3>, kUncertaintySources> sigmas_;
  std::vector<Weakest> weakest_;
};

}  // namespace palpate
