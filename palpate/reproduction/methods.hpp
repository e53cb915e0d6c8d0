// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/reproduction/virtual_paper.hpp>
#include <string>
#include <string_view>
#include <vector>

/// The rows that every table of section 4 has: the paper's three methods, IAEKF from a cold start and tuned.
namespace palpate::reproduction {

struct MethodRun {
  std::string_view name;
  int paper_row = 0;  ///< of paper_figures.hpp's tables
  bool tuned = false;
  Run run;
};

/// EKF, IEKF, IAEKF, IAEKF tuned, all from `start_N`. `options.method` is set here.
std::vector<MethodRun> run_methods(const Catheter& catheter, PaperOptions options, const Course& course,
                                   const Vector3d& start_N);

/// How far two sequences of errors are apart: |RMSE_a / RMSE_b - 1|, the largest of the axes.
double rmse_distance(const std::vector<Vector3d>& a_N, const std::vector<Vector3d>& b_N);

/// What IEKF's error consists of: the optimum that was asked for, and the lag that Q and R force on it.
struct IekfExplained {
  std::vector<Vector3d> map_N;         ///< independent_map_errors
  std::vector<Vector3d> lag_N;         ///< R as the paper's, curvature 1 mm^-2 = 1e6 m^-2
  std::vector<Vector3d> lag_metres_N;  ///< R with 1 m^-2
};
IekfExplained explain_iekf(const Catheter& catheter, const PaperOptions& options, const Course& course,
                           const Vector3d& start_N);

/// The sentence on cold and tuned, for the tables that show both.
std::string tuning_note();

}  // namespace palpate::reproduction
