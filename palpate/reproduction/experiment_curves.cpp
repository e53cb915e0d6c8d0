// SPDX-License-Identifier: Apache-2.0
#include <palpate/reproduction/experiment_curves.hpp>

namespace palpate::reproduction {
namespace {

constexpr double kMilli = 1e-3, k95 = 1.96;

std::vector<double> component(const std::vector<Vector3d>& values, int axis) {
  std::vector<double> out;
  out.reserve(values.size());
  for (const Vector3d& v : values) out.push_back(v(axis) / kMilli);
  return out;
}

plot::Series curve(const ExperimentRun& run, const std::vector<Vector3d>& values, int axis, std::string label) {
  plot::Series series;
  series.label = std::move(label);
  series.x = run.times_s;
  series.y = component(values, axis);
  return series;
}

void add_band(const std::vector<Vector3d>& sigmas, int axis, const char* label, plot::Series& series) {
  const std::vector<double> sigma = component(sigmas, axis);
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    series.lower.push_back(series.y[i] - k95 * sigma[i]);
    series.upper.push_back(series.y[i] + k95 * sigma[i]);
  }
  series.band_label = label;
}

}  // namespace

plot::Series true_series(const ExperimentRun& run, int axis, const std::string& label) {
  return curve(run, run.truth_N, axis, label);
}

plot::Series force_series(const ExperimentRun& run, Estimator estimator, int axis) {
  const EstimatedCourse& course = run.course(estimator);
  plot::Series series = curve(run, course.force_tip_N, axis, std::string(describe(estimator)));
  if (estimator == Estimator::kSmoothed) add_band(course.sigma_N, axis, "95 %, smoothed", series);
  return series;
}

plot::Series error_series(const ExperimentRun& run, Estimator estimator, int axis, double until_s) {
  plot::Series series;
  series.label = describe(estimator);
  const EstimatedCourse& course = run.course(estimator);
  for (std::size_t i = run.first; i < run.times_s.size() && run.times_s[i] <= until_s; ++i) {
    series.x.push_back(run.times_s[i]);
    series.y.push_back((course.force_tip_N[i] - run.truth_N[i])(axis) / kMilli);
  }
  return series;
}

std::vector<plot::Series> stiffness_series(const ExperimentRun& run, int which) {
  std::vector<plot::Series> out = {curve(run, run.true_stiffness_Nm2, which, "true")};
  for (const Estimator e : {Estimator::kPaperIekf, Estimator::kPaperIaekf, Estimator::kIekf})
    out.push_back(curve(run, run.course(e).stiffness_Nm2, which, std::string(describe(e))));
  add_band(run.course(Estimator::kIekf).stiffness_sigma_Nm2, which, "95 %", out.back());
  return out;
}

}  // namespace palpate::reproduction
