// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/estimation/consistency.hpp>
#include <palpate/recording/estimate_csv.hpp>
#include <palpate/recording/force_csv.hpp>
#include <span>

namespace palpate {

/// An estimate held against a force sensor: the figures of the paper's Table 7, and whether the sigmas are true.
/// error = estimate - truth, in tip components, x y z = d1 d2 d3.
struct Evaluation {
  std::size_t frames = 0;         ///< judged: after the first second, inside the truth's time span
  std::size_t outside_truth = 0;  ///< after the first second, but outside that span; not judged
  std::size_t updated = 0;        ///< of `frames`, those whose state was updated
  Vector3d mean_N = Vector3d::Zero();
  Vector3d sigma_N = Vector3d::Zero();  ///< standard deviation of the error
  Vector3d rmse_N = Vector3d::Zero();
  Vector3d largest_N = Vector3d::Zero();  ///< max |error|
  Vector3d inside_95 = Vector3d::Zero();  ///< share of frames with |error| <= 1.96 sigma
  Vector3d inside_3_sigma = Vector3d::Zero();
  double mean_nees = 0.0;      ///< normalised estimation error squared; 3 if the covariance is true
  std::size_t indefinite = 0;  ///< frames whose covariance is none (not positive definite); not in mean_nees
};

/// The first `skip_s` seconds after the estimate's first frame are left out; every other frame counts, held ones too.
/// Throws InputError where nothing is left to judge.
Evaluation evaluate(std::span<const EstimateRow> estimate, const ForceTrace& truth, double skip_s = 1.0);

}  // namespace palpate
