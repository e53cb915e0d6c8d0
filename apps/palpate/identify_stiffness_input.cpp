// SPDX-License-Identifier: Apache-2.0
#include "identify_stiffness_input.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <palpate/math/errors.hpp>

#include "identify_stiffness_recordings.hpp"

namespace palpate::app {

namespace {

LoadCase from_points(const LoadCaseEntry& entry) {
  LoadCase made{entry.name, entry.force_base_N, {}};
  for (const LoadPoint& read : entry.points) {
    ShapePoint& point = made.points.emplace_back();
    point.arc_length_m = read.arc_length_m;
    point.position_base_m = read.position_base_m;
    point.R_base_sensor = read.R_base_local;
    point.sigma_m.setConstant(read.sigma_m);
    point.sigma_rad = read.sigma_rad;
  }
  return made;
}

/// Three points or more in a line show no bend; what bends the shaft is then told by the clamp alone.
void warn_of_straight_points(const LoadCaseEntry& entry, std::vector<std::string>& warnings) {
  Eigen::Matrix3Xd places(3, static_cast<Eigen::Index>(entry.points.size()));
  for (std::size_t i = 0; i < entry.points.size(); ++i)
    places.col(static_cast<Eigen::Index>(i)) = entry.points[i].position_base_m;
  if (places.cols() < 3 || !places.allFinite() || entry.force_base_N.isZero(0.0)) return;
  const Eigen::Matrix3Xd centred = places.colwise() - places.rowwise().mean();
  const Vector3d extents = Eigen::JacobiSVD<Eigen::Matrix3Xd>(centred).singularValues();
  const double noise_m = 2.0 * entry.points[0].sigma_m * std::sqrt(static_cast<double>(places.cols()));
  if (extents(1) > std::max(1e-5 * extents(0), noise_m)) return;
  warnings.push_back(
      fmt::format("{}: case \"{}\": its {} points lie on a straight line: they show no bend, only the clamp's "
                  "direction tells of the stiffness",
                  entry.points_file.string(), entry.name, places.cols()));
}

/// Points with a sigma and points without it cannot be weighed against each other.
void refuse_mixed_sigmas(const LoadCaseFile& file, const std::vector<LoadCase>& cases) {
  const LoadCase* stated = nullptr;
  const LoadCase* open = nullptr;
  for (const LoadCase& made : cases) (made.points[0].sigma_m.isZero(0.0) ? open : stated) = &made;
  if (stated == nullptr || open == nullptr) return;
  throw InputError(fmt::format(
      "{}: case \"{}\": expected sigma_mm at its points, for those of case \"{}\" have one (a recording's always do)",
      file.source, open->name, stated->name));
}

}  // namespace

StiffnessInput load_stiffness_input(const CatheterFile& file, const LoadCaseFile& cases) {
  StiffnessInput input;
  input.catheter = file.catheter;
  input.warnings = file.warnings;
  for (const LoadCaseEntry& entry : cases.cases) {
    input.cases.push_back(from_points(entry));
    warn_of_straight_points(entry, input.warnings);
  }
  load_recorded_cases(file, cases, input);
  refuse_mixed_sigmas(cases, input.cases);
  return input;
}

}  // namespace palpate::app
