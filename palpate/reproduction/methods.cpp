// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/reproduction/independent_map.hpp>
#include <palpate/reproduction/methods.hpp>

namespace palpate::reproduction {

std::vector<MethodRun> run_methods(const Catheter& catheter, PaperOptions options, const Course& course,
                                   const Vector3d& start_N) {
  std::vector<MethodRun> runs{
      {.name = "EKF", .paper_row = 0, .run = {}},
      {.name = "IEKF", .paper_row = 1, .run = {}},
      {.name = "IAEKF, cold start", .paper_row = 2, .run = {}},
      {.name = "IAEKF, tuned", .paper_row = 2, .tuned = true, .run = {}},
  };
  for (MethodRun& r : runs) {
    options.method = static_cast<PaperMethod>(r.paper_row);
    r.run =
        run_filter(catheter, options, course, {.force_tip_N = start_N, .tuning_samples = r.tuned ? kTuningSamples : 0});
  }
  return runs;
}

double rmse_distance(const std::vector<Vector3d>& a_N, const std::vector<Vector3d>& b_N) {
  const Vector3d a = statistics(a_N).rmse, b = statistics(b_N).rmse;
  return (a.cwiseQuotient(b) - Vector3d::Ones()).cwiseAbs().maxCoeff();
}

IekfExplained explain_iekf(const Catheter& catheter, const PaperOptions& options, const Course& course,
                           const Vector3d& start_N) {
  PaperNoise metres = options.R;
  metres.tail<3>() *= 1e-6;
  return {.map_N = independent_map_errors(catheter, course, options.Q_N2, {options.R}, start_N),
          .lag_N = forced_lag(catheter, course, options.Q_N2, {options.R}, start_N),
          .lag_metres_N = forced_lag(catheter, course, options.Q_N2, {metres}, start_N)};
}

std::string tuning_note() {
  return fmt::format(
      "IAEKF adapts R alone, for Q and R together cannot be told apart: from post-fit residuals of the last M = 15 "
      "steps, "
      "R_i = cov(r_i) + mean((J P J^T)_ii), no less than 1e-6 of the paper's R. The data are exact, so R falls from "
      "window to window and the lag with it. From a cold start the first windows still carry the paper's R and make "
      "most "
      "of the error; \"tuned\" has adapted R on {} samples of the unmoved catheter before step 0 (\"when the filters "
      "are "
      "tuned initially\", section 4.1).\n",
      kTuningSamples);
}

}  // namespace palpate::reproduction
