// SPDX-License-Identifier: Apache-2.0
#include "precurvature_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <palpate/math/units.hpp>
#include <palpate/plot/plot.hpp>
#include <palpate/recording/catheter_tendon_map.hpp>

namespace palpate::app {

namespace {

constexpr double k95 = 1.959964;

nlohmann::json array(const Eigen::VectorXd& values) {
  nlohmann::json out = nlohmann::json::array();
  for (const double value : values) out.push_back(std::isfinite(value) ? nlohmann::json(value) : nlohmann::json());
  return out;
}

/// In the base frame; a component that was not measured is the fitted one.
Vector3d in_base(const ArcFit& fit, const Vector3d& p_frame, const Vector3d& otherwise) {
  Vector3d p = p_frame;
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(p(axis))) p(axis) = otherwise(axis);
  return fit.T_frame_base.inverse() * p;
}

/// Direction into which the shaft bends, base axes: k1 > 0 turns the tangent towards -d2, k2 > 0 towards d1.
Vector3d bending_side(const ArcFit& fit) {
  const Vector3d k = fit.precurvature_per_m;
  const double size = k.head<2>().norm();
  return size > 1e-9 ? Vector3d(k.y() / size, -k.x() / size, 0.0) : Vector3d(0.0, -1.0, 0.0);
}

}  // namespace

std::string in_words(const ArcFit& fit) {
  const char* names[] = {"k1,0", "k2,0", "tau0"};
  std::string out;
  for (int i = 0; i < 3; ++i) {
    const double k = fit.precurvature_per_m(i), sigma = std::sqrt(fit.covariance(i, i));
    if (!fit.told[static_cast<std::size_t>(i)]) {
      out += fmt::format("  {} = {:>10.4f} 1/m, kept, not told by these data\n", names[i], k);
      continue;
    }
    const double half = fit.interval_factor * sigma;
    out += fmt::format("  {} = {:>10.4f} 1/m, sigma {:.4f}, 95 % interval {:.4f} to {:.4f}\n", names[i], k, sigma,
                       k - half, k + half);
  }
  out += fmt::format("{} places, rms {:.4f} mm, chi-square {:.1f} for {} degrees of freedom\n", fit.places.size(),
                     fit.rms_m * kMillimetresPerMetre, fit.chi_square, fit.degrees_of_freedom);
  out += fmt::format(
      "were the curvature to change along the shaft: by ({:.2f}, {:.2f}) 1/m; so much by noise alone: "
      "probability {:.2g}\n",
      fit.change_along_per_m.x(), fit.change_along_per_m.y(), fit.change_probability);
  return out;
}

nlohmann::json to_json(const ArcFit& fit) {
  const Vector3d sigma = fit.covariance.diagonal().cwiseSqrt();
  nlohmann::json places = nlohmann::json::array();
  for (const ArcFit::Place& place : fit.places)
    places.push_back({{"arc_length_mm", place.arc_length_m * kMillimetresPerMetre},
                      {"residual_mm", array((place.measured_m - place.fitted_m) * kMillimetresPerMetre)},
                      {"residual_deg", array(place.turn_rad / kRadiansPerDegree)}});
  const Eigen::Quaterniond q(fit.T_frame_base.R);
  return {
      {"precurvature_per_m", array(fit.precurvature_per_m)},
      {"precurvature_sigma_per_m", array(sigma)},
      {"interval_95_half_width_per_m", array(fit.interval_factor * sigma)},
      {"covariance_per_m2", {array(fit.covariance.row(0)), array(fit.covariance.row(1)), array(fit.covariance.row(2))}},
      {"told", fit.told},
      {"clamp",
       {{"position_mm", array(fit.T_frame_base.p * kMillimetresPerMetre)},
        {"quaternion_wxyz", {q.w(), q.x(), q.y(), q.z()}}}},
      {"rms_mm", fit.rms_m * kMillimetresPerMetre},
      {"point_sigma_mm", fit.point_sigma_m * kMillimetresPerMetre},
      {"chi_square", fit.chi_square},
      {"degrees_of_freedom", fit.degrees_of_freedom},
      {"change_along_per_m", array(fit.change_along_per_m)},
      {"change_probability", fit.change_probability},
      {"places", places}};
}

void plot_arc(const Catheter& catheter, const ArcFit& fit, const std::string& path) {
  const Vector3d side = bending_side(fit), normal = Vector3d::UnitZ().cross(side);
  plot::Series arc{.label = "fitted arc"}, points{.label = "measured", .style = plot::Style::kPoints};
  for (const Vector3d& p : fitted_curve(catheter, fit)) {
    const Vector3d p_base = in_base(fit, p, p);
    arc.x.push_back(p_base.z() * kMillimetresPerMetre);
    arc.y.push_back(side.dot(p_base) * kMillimetresPerMetre);
  }
  plot::Series rest[] = {{.label = "in the bending plane", .style = plot::Style::kPoints},
                         {.label = "across it", .style = plot::Style::kPoints},
                         {.label = "along the straight shaft", .style = plot::Style::kPoints}};
  for (const ArcFit::Place& place : fit.places) {
    const Vector3d measured = in_base(fit, place.measured_m, place.fitted_m);
    const Vector3d error = measured - in_base(fit, place.fitted_m, place.fitted_m);
    points.x.push_back(measured.z() * kMillimetresPerMetre);
    points.y.push_back(side.dot(measured) * kMillimetresPerMetre);
    const double parts[] = {side.dot(error), normal.dot(error), error.z()};
    for (int i = 0; i < 3; ++i) {
      rest[i].x.push_back(place.arc_length_m * kMillimetresPerMetre);
      rest[i].y.push_back(parts[i] * kMillimetresPerMetre);
    }
  }
  plot::Figure figure{.title = fmt::format("{}: k1,0 = {:.2f}, k2,0 = {:.2f} 1/m, rms {:.3f} mm", catheter.name,
                                           fit.precurvature_per_m.x(), fit.precurvature_per_m.y(),
                                           fit.rms_m * kMillimetresPerMetre)};
  figure.panels.push_back({.title = "in the bending plane",
                           .x_label = "along the straight shaft [mm]",
                           .y_label = "to the side [mm]",
                           .series = {arc, points}});
  figure.panels.push_back({.title = {},
                           .x_label = "arc length from the clamp [mm]",
                           .y_label = "measured - fitted [mm]",
                           .series = {rest[0], rest[1], rest[2]}});
  plot::write_figure(figure, path);
}

namespace {

std::string unit_of(TendonInput input) {
  if (input == TendonInput::kKnob) return "rad";
  return input == TendonInput::kDisplacement ? "mm" : "N";
}

std::string label_of(TendonInput input) {
  if (input == TendonInput::kKnob) return "knob [rad]";
  return input == TendonInput::kDisplacement ? "tendon displacement [mm]" : "tendon tension [N]";
}

/// Linear between the map's positions, which stand at equal steps.
double sigma_at(const std::vector<Eigen::Vector2d>& sigma, double share, int axis) {
  const double place = share * static_cast<double>(sigma.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(place), sigma.size() - 2);
  const double weight = place - static_cast<double>(low);
  return (1.0 - weight) * sigma[low](axis) + weight * sigma[low + 1](axis);
}

plot::Series branch_curve(const TendonMapFit& fit, bool release, int axis) {
  constexpr int kSteps = 150;
  const TendonPlay play(fit.map, Eigen::Vector2d::Zero());
  const double unit = si_per_unit(fit.map.input), from = fit.map.position.front(), to = fit.map.position.back();
  plot::Series out{.label = release ? "release" : "pull", .band_label = release ? "95 % of release" : "95 % of pull"};
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps, position = from + share * (to - from);
    const double k = (release ? play.release_per_m(position) : play.pull_per_m(position))(axis);
    const double half = k95 * sigma_at(release ? fit.release_sigma_per_m : fit.pull_sigma_per_m, share, axis);
    out.x.push_back(position / unit);
    out.y.push_back(k);
    out.lower.push_back(k - half);
    out.upper.push_back(k + half);
  }
  return out;
}

plot::Series sample_points(const TendonMapFit& fit, std::span<const HandleSample> samples, bool release, int axis,
                           bool residual) {
  plot::Series out{.label = release ? "released to" : "pulled to", .style = plot::Style::kPoints};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].release != release) continue;
    out.x.push_back(samples[i].position / si_per_unit(fit.map.input));
    out.y.push_back((residual ? fit.residual_per_m[i] : samples[i].precurvature_per_m)(axis));
  }
  return out;
}

}  // namespace

std::string in_words(const TendonMapFit& fit) {
  const double unit = si_per_unit(fit.map.input);
  std::string out =
      fmt::format("tendon map over {}, {} to {}: {} samples pulled to, {} released to\n", name_of(fit.map.input),
                  fit.map.position.front() / unit, fit.map.position.back() / unit, fit.pulls, fit.releases);
  out += fmt::format("  k1,0 pulled from {:.2f} to {:.2f} 1/m, released to {:.2f} 1/m\n",
                     fit.map.pull_per_m.front().x(), fit.map.pull_per_m.back().x(), fit.map.release_per_m.front().x());
  out += fmt::format("  hysteresis: {:.2f} 1/m wide on average, {:.2f} at most; dead zone {:.3g} {}\n",
                     fit.mean_width_per_m, fit.largest_width_per_m, fit.dead_zone / unit, unit_of(fit.map.input));
  out += fmt::format("  samples scatter by ({:.3f}, {:.3f}) 1/m, sigma of the map ({:.3f}, {:.3f}) 1/m\n",
                     fit.scatter_per_m.x(), fit.scatter_per_m.y(), fit.map.sigma_per_m.x(), fit.map.sigma_per_m.y());
  return out;
}

nlohmann::json to_json(const TendonMapFit& fit, std::span<const HandleSample> samples) {
  const double unit = si_per_unit(fit.map.input);
  nlohmann::json position, pull, release, seen = nlohmann::json::array();
  for (std::size_t i = 0; i < fit.map.position.size(); ++i) {
    position.push_back(fit.map.position[i] / unit);
    pull.push_back(array(fit.map.pull_per_m[i]));
    release.push_back(array(fit.map.release_per_m[i]));
  }
  for (std::size_t i = 0; i < samples.size(); ++i)
    seen.push_back({{"position", samples[i].position / unit},
                    {"direction", samples[i].release ? "release" : "pull"},
                    {"precurvature_per_m", array(samples[i].precurvature_per_m)},
                    {"residual_per_m", array(fit.residual_per_m[i])}});
  return {{"input", name_of(fit.map.input)},
          {"position", position},
          {"pull_per_m", pull},
          {"release_per_m", release},
          {"sigma_per_m", array(fit.map.sigma_per_m)},
          {"scatter_per_m", array(fit.scatter_per_m)},
          {"mean_width_per_m", fit.mean_width_per_m},
          {"largest_width_per_m", fit.largest_width_per_m},
          {"dead_zone", fit.dead_zone / unit},
          {"samples", seen}};
}

void plot_map(const TendonMapFit& fit, std::span<const HandleSample> samples, const std::string& title,
              const std::string& path) {
  plot::Figure figure{.title = title};
  const std::string x_label = label_of(fit.map.input);
  const auto add = [&](const char* heading, const char* y_label, int axis, bool residual) {
    plot::Panel panel{.title = heading, .x_label = x_label, .y_label = y_label};
    for (const bool release : {false, true}) {
      if (release && fit.releases == 0) continue;
      if (!residual) panel.series.push_back(branch_curve(fit, release, axis));
    }
    for (const bool release : {false, true}) {
      if (release && fit.releases == 0) continue;
      panel.series.push_back(sample_points(fit, samples, release, axis, residual));
    }
    figure.panels.push_back(std::move(panel));
  };
  add("", "k1,0 [1/m]", 0, false);
  if (fit.scatter_per_m.y() > 1e-9) add("", "k2,0 [1/m]", 1, false);
  add("", "k1,0 measured - map [1/m]", 0, true);
  plot::write_figure(figure, path);
}

}  // namespace palpate::app
