// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <numeric>
#include <palpate/reproduction/force_pictures.hpp>

namespace palpate::reproduction {

std::vector<double> step_numbers(std::size_t count) {
  std::vector<double> steps(count);
  std::iota(steps.begin(), steps.end(), 0.0);
  return steps;
}

std::vector<double> axis_values(const std::vector<Vector3d>& forces_N, int axis, double factor) {
  std::vector<double> values;
  for (const Vector3d& F : forces_N) values.push_back(factor * F(axis));
  return values;
}

plot::Figure error_figure(const std::string& title, const std::vector<MethodRun>& runs) {
  plot::Figure figure{.title = title};
  for (int axis = 0; axis < 3; ++axis) {
    plot::Panel panel{
        .x_label = "step (15 a second)", .y_label = fmt::format("|e({})| [N]", kForceNames[axis]), .log_y = true};
    for (const MethodRun& r : runs) {
      std::vector<double> e = axis_values(r.run.error_N, axis);
      for (double& value : e) value = std::abs(value) < 1e-12 ? std::nan("") : std::abs(value);
      panel.series.push_back({.label = std::string(r.name), .x = step_numbers(e.size()), .y = std::move(e)});
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace palpate::reproduction
