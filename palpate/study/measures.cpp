// SPDX-License-Identifier: Apache-2.0
#include <palpate/study/measures.hpp>

namespace palpate::study {

std::vector<std::string> column_names(std::span<const Measure> measures) {
  std::vector<std::string> names;
  for (const Measure measure : measures) {
    switch (measure) {
      case Measure::kRmse:
        names.insert(names.end(), {"rmse_x_N", "rmse_y_N", "rmse_z_N"});
        break;
      case Measure::kBias:
        names.insert(names.end(), {"bias_x_N", "bias_y_N", "bias_z_N"});
        break;
      case Measure::kCoverage:
        names.insert(names.end(), {"inside_95_x", "inside_95_y", "inside_95_z"});
        break;
      case Measure::kNees:
        names.emplace_back("nees");
        break;
      case Measure::kNis:
        names.emplace_back("nis_per_dof");
        break;
      case Measure::kEvaluations:
        names.emplace_back("evaluations");
        break;
      case Measure::kUpdated:
        names.emplace_back("updated");
        break;
    }
  }
  return names;
}

std::vector<double> column_values(const Figures& figures, std::span<const Measure> measures) {
  std::vector<double> values;
  const auto add = [&](const Vector3d& v) { values.insert(values.end(), {v.x(), v.y(), v.z()}); };
  for (const Measure measure : measures) {
    switch (measure) {
      case Measure::kRmse:
        add(figures.rmse_N);
        break;
      case Measure::kBias:
        add(figures.bias_N);
        break;
      case Measure::kCoverage:
        add(figures.inside_95);
        break;
      case Measure::kNees:
        values.push_back(figures.nees);
        break;
      case Measure::kNis:
        values.push_back(figures.nis_per_dof);
        break;
      case Measure::kEvaluations:
        values.push_back(figures.evaluations);
        break;
      case Measure::kUpdated:
        values.push_back(figures.updated);
        break;
    }
  }
  return values;
}

}  // namespace palpate::study
