// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/estimation/consistency.hpp>
#include <palpate/math/units.hpp>
#include <palpate/plot/plot.hpp>
#include <palpate/rod/base_loads.hpp>

#include "identify_registration_report.hpp"

namespace palpate::app {

namespace {

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

std::vector<Vector3d> centre_line(const Registration& found, const Registration::Position& position) {
  constexpr int kPoints = 36;
  Rod rod = found.catheter.rod;
  const auto flexible =
      std::find_if(rod.sections.begin(), rod.sections.end(), [](const Section& section) { return !section.rigid; });
  TipLoad load;
  if (flexible != rod.sections.end())
    load.precurvature_per_m = position.precurvature_per_m - flexible->precurvature_per_m;
  std::vector<double> arc_lengths_m;
  for (int k = 0; k <= kPoints; ++k) arc_lengths_m.push_back((rod.length_m() + rod.rigid_tip_m) * k / kPoints);
  const RodSolver solver(rod, arc_lengths_m);
  RodSolution<3> shape = solver.make_solution<3>();
  auto workspace = make_weight_workspace<3>(solver);
  solve_under_weight(solver, load, LoadDirections<3>{}, workspace, shape);
  std::vector<Vector3d> line;
  for (const RodPoint& point : shape.points) line.push_back(point.T_base_local.p);
  return line;
}

/// The transverse axis along which the shafts reach farthest.
int side_axis(const std::vector<std::vector<Vector3d>>& lines) {
  Vector3d reach = Vector3d::Zero();
  for (const auto& line : lines)
    for (const Vector3d& point : line) reach = reach.cwiseMax(point.cwiseAbs());
  return reach.x() > reach.y() ? 0 : 1;
}

plot::Panel side_view(const Registration& found, std::span<const KnobPosition> measured) {
  constexpr double kCross_m = 0.8e-3;
  std::vector<std::vector<Vector3d>> lines;
  for (const auto& position : found.positions) lines.push_back(centre_line(found, position));
  const int axis = side_axis(lines);
  plot::Panel panel{
      .title = "side view", .x_label = "along e3 of the clamp [mm]", .y_label = axis == 0 ? "e1 [mm]" : "e2 [mm]"};
  const auto add = [&](const Vector3d& point, plot::Series& series) {
    series.x.push_back(point.z() * kMillimetresPerMetre);
    series.y.push_back(point(axis) * kMillimetresPerMetre);
  };
  plot::Series fitted{.label = "fitted"};
  for (const auto& line : lines) {
    for (const Vector3d& point : line) add(point, fitted);
    add(Vector3d::Constant(kGap), fitted);
  }
  const Pose T_base_reference = found.T_reference_base.inverse();
  for (std::size_t i = 0; i < found.catheter.sensors.size(); ++i) {
    plot::Series sensor{.label = fmt::format("{}, measured", found.catheter.sensors[i].name)};
    for (std::size_t j = 0; j < measured.size(); ++j) {
      if (!found.positions[j].residuals[i].seen) continue;
      const Vector3d centre = T_base_reference * measured[j].poses[i].T_base_sensor.p;
      for (const Vector3d& arm : {Vector3d(Vector3d::UnitZ()), Vector3d(Vector3d::Unit(axis))}) {  // a cross
        add(centre - kCross_m * arm, sensor);
        add(centre + kCross_m * arm, sensor);
        add(Vector3d::Constant(kGap), sensor);
      }
    }
    panel.series.push_back(std::move(sensor));
  }
  panel.series.push_back(std::move(fitted));
  return panel;
}

/// How far one sensor is off at every knob position, as bars side by side with those of the other sensors.
plot::Series bars(const Registration& found, std::size_t sensor, bool rotation) {
  constexpr double kBarWidth = 0.12;
  plot::Series series{.label = found.catheter.sensors[sensor].name};
  const double side =
      kBarWidth * (static_cast<double>(sensor) - 0.5 * (static_cast<double>(found.catheter.sensors.size()) - 1.0));
  for (std::size_t j = 0; j < found.positions.size(); ++j) {
    const auto& r = found.positions[j].residuals[sensor];
    if (!r.seen) continue;
    const double x = static_cast<double>(j + 1) + side;
    const double height =
        rotation ? r.rotation_rad.norm() / kRadiansPerDegree : r.position_m.norm() * kMillimetresPerMetre;
    for (const double edge : {-0.45, 0.45, kGap}) series.x.push_back(x + kBarWidth * edge);
    for (const double y : {height, height, kGap}) series.y.push_back(y);
    for (const double edge : {0.0, 0.0, kGap}) series.x.push_back(x + kBarWidth * edge);
    for (const double y : {0.0, height, kGap}) series.y.push_back(y);
  }
  return series;
}

/// Noise alone keeps 95 % below: three (or two) axes of equal sigma.
plot::Series expected(const Registration& found, bool rotation) {
  const double quantile = std::sqrt(chi_square_tail_quantile(0.05, 3));
  plot::Series series{.label = "95 % of stated noise"};
  for (std::size_t j = 0; j < found.positions.size(); ++j) {
    double sigma = 0.0;
    for (const auto& r : found.positions[j].residuals)
      sigma = std::max(sigma, rotation ? r.sigma_rad / kRadiansPerDegree : r.sigma_m * kMillimetresPerMetre);
    const double at = static_cast<double>(j + 1);
    for (const double x : {at - 0.4, at + 0.4, kGap}) series.x.push_back(x);
    for (const double y : {quantile * sigma, quantile * sigma, kGap}) series.y.push_back(y);
  }
  return series;
}

plot::Panel residuals(const Registration& found, bool rotation) {
  plot::Panel panel{.title = rotation ? "orientation" : "place",
                    .x_label = "knob position, in the order given",
                    .y_label = rotation ? "measured - fitted [deg]" : "measured - fitted [mm]"};
  for (std::size_t i = 0; i < found.catheter.sensors.size(); ++i)
    if (!rotation || found.catheter.sensors[i].kind != SensorKind::kPosition)
      panel.series.push_back(bars(found, i, rotation));
  panel.series.push_back(expected(found, rotation));
  return panel;
}

}  // namespace

void plot_registration(const Registration& found, std::span<const KnobPosition> measured, const std::string& file) {
  plot::Figure figure{
      .title = fmt::format("Registration of {}", found.catheter.name), .width_px = 900, .height_px = 1300};
  figure.panels = {side_view(found, measured), residuals(found, false)};
  const auto& sensors = found.catheter.sensors;
  if (std::any_of(sensors.begin(), sensors.end(), [](const Sensor& s) { return s.kind != SensorKind::kPosition; }))
    figure.panels.push_back(residuals(found, true));
  plot::write_figure(figure, file);
}

}  // namespace palpate::app
