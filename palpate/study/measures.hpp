// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <palpate/math/rotation.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::study {

/// What is measured of a run. Each is one column, or three: along d1, d2, d3 of the tip.
enum class Measure : std::uint8_t { kRmse, kBias, kCoverage, kNees, kNis, kEvaluations, kUpdated };
inline constexpr std::array<std::string_view, 7> kMeasureNames{"rmse", "bias",        "coverage", "nees",
                                                               "nis",  "evaluations", "updated"};

/// All that can be measured of one run, over its judged frames.
struct Figures {
  Vector3d rmse_N = Vector3d::Zero();
  Vector3d bias_N = Vector3d::Zero();     ///< mean error
  Vector3d inside_95 = Vector3d::Zero();  ///< share of frames with the truth inside the 95 % interval
  double nees = 0.0;                      ///< mean e^T P^-1 e: 3 where the covariance is true
  double nis_per_dof = 0.0;               ///< mean: 1 where prediction and noise are as claimed
  double evaluations = 0.0;               ///< rod solutions a frame, mean
  double updated = 0.0;                   ///< share of frames that were used
};

/// "rmse_x_N", ...: the columns of the results, in order.
std::vector<std::string> column_names(std::span<const Measure> measures);
std::vector<double> column_values(const Figures& figures, std::span<const Measure> measures);

}  // namespace palpate::study
