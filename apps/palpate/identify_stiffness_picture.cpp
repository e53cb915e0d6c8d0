// SPDX-License-Identifier: Apache-2.0
#include "identify_stiffness_picture.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <palpate/math/units.hpp>
#include <palpate/rod/base_loads.hpp>

namespace palpate::app {

namespace {

constexpr std::size_t kColours = 7;     // of the plots: a case's points have the colour of its curve that far behind it
constexpr std::size_t kBandColour = 5;  // a light one
constexpr std::size_t kStations = 81;
constexpr double kTwoSided95 = 1.959964;
constexpr const char* kAxis[] = {"x", "y", "z"};

using Curve = std::vector<Vector3d>;  ///< along the shaft, base frame [m]

Curve solve_curve(const Rod& rod, const Vector3d& force_base_N) {
  std::vector<double> stations_m;
  for (std::size_t i = 0; i < kStations; ++i)
    stations_m.push_back(rod.length_m() * static_cast<double>(i) / static_cast<double>(kStations - 1));
  const RodSolver solver(rod, stations_m);
  RodSolution<0> solution = solver.make_solution<0>();
  solver.solve(follow_from_rest(solver, {.force_base_N = force_base_N, .tip = {}}).load, solution);
  Curve curve;
  for (const RodPoint& point : solution.points) curve.push_back(point.T_base_local.p);
  return curve;
}

/// The shape as the load case gives it: with own weight, or with its effect taken off.
Curve case_curve(Rod rod, const Vector3d& force_base_N, StiffnessOptions::OwnWeight own_weight) {
  Curve curve = solve_curve(rod, force_base_N);
  if (own_weight == StiffnessOptions::OwnWeight::kIncluded || !rod.has_distributed_load()) return curve;
  const Curve hanging = solve_curve(rod, Vector3d::Zero());
  rod.distributed_load_base_N_per_m.setZero();
  const Curve free = solve_curve(rod, Vector3d::Zero());
  for (std::size_t i = 0; i < curve.size(); ++i) curve[i] += free[i] - hanging[i];
  return curve;
}

/// Half the width of the 95 % band: root sum of squares over the principal directions of ln K, by differences.
Curve half_widths(const StiffnessReport& report, const Matrix3d& covariance, const Vector3d& force_base_N,
                  const Curve& fitted) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(covariance);
  Curve squares(fitted.size(), Vector3d::Zero());
  for (int k = 0; k < 3; ++k) {
    const double sigma = std::sqrt(std::max(0.0, principal.eigenvalues()(k)));
    if (sigma < 1e-6) continue;
    const double step = std::min(sigma, 0.05);  // small enough to be linear
    Rod rod = report.fit.rod;
    for (Section& section : rod.sections)
      section.stiffness_Nm2.array() *= (step * principal.eigenvectors().col(k)).array().exp();
    const Curve moved = case_curve(rod, force_base_N, report.options.own_weight);
    for (std::size_t i = 0; i < fitted.size(); ++i) squares[i] += (sigma / step * (moved[i] - fitted[i])).cwiseAbs2();
  }
  for (Vector3d& square : squares) square = kTwoSided95 * square.cwiseSqrt();
  return squares;
}

/// One curve with its band, seen along one lateral axis.
plot::Series curve_series(const std::string& label, const Curve& fitted, const Curve& half, int axis) {
  plot::Series series{.label = label};
  for (std::size_t i = 0; i < fitted.size(); ++i) {
    const double y_mm = fitted[i](axis) * kMillimetresPerMetre, half_mm = half[i](axis) * kMillimetresPerMetre;
    series.x.push_back(fitted[i].z() * kMillimetresPerMetre);
    series.y.push_back(y_mm);
    series.lower.push_back(y_mm - half_mm);
    series.upper.push_back(y_mm + half_mm);
  }
  return series;
}

/// How far along the clamp's axis a point is: as measured, else as fitted.
double along_mm(const LoadCase& load, const StiffnessFit::Case& fitted, std::size_t i) {
  const double measured_m = load.points[i].position_base_m.z();
  return (std::isnan(measured_m) ? fitted.T_base_point[i].p.z() : measured_m) * kMillimetresPerMetre;
}

bool measured(const StiffnessReport& report, int axis) {
  for (const LoadCase& load : report.load_cases)
    for (const ShapePoint& point : load.points)
      if (!std::isnan(point.position_base_m(axis))) return true;
  return false;
}

bool has_residual(const StiffnessReport& report, int axis) {
  for (const StiffnessFit::Case& fitted : report.fit.cases)
    for (const Vector3d& residual_m : fitted.residual_m)
      if (!std::isnan(residual_m(axis))) return true;
  return false;
}

/// Curves first, then points, in blocks of as many as there are colours.
plot::Panel shape_panel(const StiffnessReport& report, const std::vector<Curve>& curves,
                        const std::vector<Curve>& halves, int axis) {
  plot::Panel panel{.x_label = "along the clamp's axis, z [mm]", .y_label = fmt::format("{} [mm]", kAxis[axis])};
  for (std::size_t first = 0; first < curves.size(); first += kColours) {
    const std::size_t end = std::min(first + kColours, curves.size());
    for (std::size_t i = first; i < end; ++i)
      panel.series.push_back(curve_series(report.load_cases[i].name, curves[i], halves[i], axis));
    for (std::size_t i = end; i < first + kColours; ++i) panel.series.emplace_back();  // keeps the colours in step
    for (std::size_t i = first; i < end; ++i) {
      plot::Series points{.style = plot::Style::kPoints};
      for (std::size_t j = 0; j < report.load_cases[i].points.size(); ++j) {
        points.x.push_back(along_mm(report.load_cases[i], report.fit.cases[i], j));
        points.y.push_back(report.load_cases[i].points[j].position_base_m(axis) * kMillimetresPerMetre);
      }
      panel.series.push_back(std::move(points));
    }
    for (std::size_t i = end; i < first + kColours; ++i) panel.series.emplace_back();
  }
  return panel;
}

plot::Panel residual_panel(const StiffnessReport& report, int axis) {
  plot::Panel panel{.x_label = "along the clamp's axis, z [mm]", .y_label = fmt::format("{} off [mm]", kAxis[axis])};
  const double sigma_mm = report.fit.point_sigma_m * kMillimetresPerMetre;
  plot::Series band{.x = {0.0, report.fit.rod.length_m() * kMillimetresPerMetre}, .y = {0.0, 0.0}};
  band.lower.assign(2, -kTwoSided95 * sigma_mm);
  band.upper.assign(2, kTwoSided95 * sigma_mm);
  for (std::size_t i = 0; i < report.load_cases.size(); ++i) {
    plot::Series points{.style = plot::Style::kPoints};
    for (std::size_t j = 0; j < report.fit.cases[i].residual_m.size(); ++j) {
      points.x.push_back(along_mm(report.load_cases[i], report.fit.cases[i], j));
      points.y.push_back(report.fit.cases[i].residual_m[j](axis) * kMillimetresPerMetre);
    }
    panel.series.push_back(std::move(points));
  }
  while (panel.series.size() < kBandColour) panel.series.emplace_back();  // where there is room for it
  panel.series.push_back(std::move(band));
  return panel;
}

}  // namespace

plot::Figure stiffness_figure(const StiffnessReport& report, const Catheter& before) {
  const Matrix3d covariance = log_stiffness_covariance(report.fit, report.options.unknowns, before);
  std::vector<Curve> curves, halves;
  for (const LoadCase& load : report.load_cases) {
    curves.push_back(case_curve(report.fit.rod, load.force_base_N, report.options.own_weight));
    halves.push_back(half_widths(report, covariance, load.force_base_N, curves.back()));
  }
  const std::string name = before.name.empty() ? "Stiffness" : fmt::format("Stiffness of {}", before.name);
  plot::Figure figure{.title = name + ". Points: measured; curves: fitted, with 95 % band"};
  for (int axis = 0; axis < 2; ++axis)
    if (measured(report, axis)) figure.panels.push_back(shape_panel(report, curves, halves, axis));
  const std::size_t shapes = figure.panels.size();
  for (int axis = 0; axis < 3; ++axis)
    if (has_residual(report, axis)) figure.panels.push_back(residual_panel(report, axis));
  if (figure.panels.size() > shapes)
    figure.panels[shapes].title = "measured - fitted; shaded: 95 % by the sigma of a point";
  figure.height_px = 100 + 190 * static_cast<int>(std::max<std::size_t>(figure.panels.size(), 2));
  return figure;
}

}  // namespace palpate::app
