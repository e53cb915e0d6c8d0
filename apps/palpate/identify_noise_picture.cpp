// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <palpate/math/units.hpp>
#include <palpate/plot/plot.hpp>

#include "identify_noise_report.hpp"

namespace palpate::app {

namespace {

constexpr double kDegrees = 1.0 / kRadiansPerDegree;
constexpr std::array kAxes{"x", "y", "z"};

std::vector<double> scaled(const std::vector<double>& values, double scale) {
  std::vector<double> out;
  out.reserve(values.size());
  for (const double value : values) out.push_back(scale * value);
  return out;
}

plot::Panel deviations(const SensorNoise& s) {
  plot::Panel panel{
      .title = fmt::format("sensor {}: position about its mean", s.name), .x_label = "time [s]", .y_label = "[mm]"};
  for (int axis = 0; axis < 3; ++axis) {
    plot::Series series{.label = kAxes[static_cast<std::size_t>(axis)], .x = s.rest->times_s};
    for (const Vector6d& d : s.rest->deviations) series.y.push_back(d(axis) * kMillimetresPerMetre);
    panel.series.push_back(std::move(series));
  }
  return panel;
}

plot::Panel innovations(const SensorNoise& s) {
  plot::Panel panel{.title = fmt::format("sensor {}: position against its prediction", s.name),
                    .x_label = "time [s]",
                    .y_label = "[sigmas]"};
  for (std::size_t axis = 0; axis < 3; ++axis)
    panel.series.push_back({.label = kAxes[axis],
                            .x = s.moving->channels[axis].times_s,
                            .y = s.moving->channels[axis].innovations,
                            .style = plot::Style::kPoints});
  return panel;
}

plot::Panel allan(const std::vector<const SensorNoise*>& sensors, bool rotation) {
  plot::Panel panel{.title = rotation
                                 ? "Allan deviation of the orientation: white noise falls as 1 / root of the window"
                                 : "Allan deviation of the position: white noise falls as 1 / root of the window",
                    .x_label = "window [s]",
                    .y_label = rotation ? "[deg]" : "[mm]",
                    .log_x = true};
  for (const SensorNoise* s : sensors) {
    const AllanDeviation& a = s->rest->allan;
    if (rotation && a.rotation_rad.empty()) continue;
    panel.series.push_back(
        {.label = s->name,
         .x = a.tau_s,
         .y = rotation ? scaled(a.rotation_rad, kDegrees) : scaled(a.position_m, kMillimetresPerMetre)});
  }
  return panel;
}

nlohmann::json numbers(const Eigen::VectorXd& m) {
  nlohmann::json out = nlohmann::json::array();
  for (Eigen::Index i = 0; i < m.size(); ++i) out.push_back(m(i));
  return out;
}

template <class Noise>
void add_counts(const Noise& n, nlohmann::json& json) {
  json["frames"] = n.frames;
  json["missing"] = n.missing;
  json["unusable"] = n.unusable;
  json["not_in_time_order"] = n.bad_times;
  json["used"] = n.used;
  json["dropout_share"] =
      n.frames > 0 ? static_cast<double>(n.missing + n.unusable) / static_cast<double>(n.frames) : 0.0;
  json["mean_rate_Hz"] = n.timing.mean_rate_Hz;
  json["period_s"] = n.timing.period_s;
  json["jitter_s"] = n.timing.jitter_s;
  json["longest_gap_s"] = n.timing.longest_gap_s;
}

nlohmann::json rest_json(const RestNoise& n) {
  constexpr std::array kWords{"still", "drifts", "moves"};
  nlohmann::json json{{"rest", kWords[static_cast<std::size_t>(n.rest)]}};
  add_counts(n, json);
  json["outliers"] = n.outliers;
  json["distinct"] = n.distinct;
  nlohmann::json rows = nlohmann::json::array();
  for (int row = 0; row < 6; ++row) rows.push_back(numbers(n.covariance.row(row).transpose()));
  json["covariance_m_rad"] = rows;
  json["worst_position_sigma_mm"] = n.worst_position_sigma_m() * kMillimetresPerMetre;
  json["fast_position_sigma_mm"] = n.white_m * kMillimetresPerMetre;
  json["slow_position_sigma_mm"] = n.slow_m * kMillimetresPerMetre;
  if (n.has_orientation) {
    json["worst_orientation_sigma_deg"] = n.worst_rotation_sigma_rad() * kDegrees;
    json["fast_orientation_sigma_deg"] = n.white_rad * kDegrees;
    json["slow_orientation_sigma_deg"] = n.slow_rad * kDegrees;
  }
  json["position_step_mm"] = numbers(n.step.head<3>() * kMillimetresPerMetre);
  json["correlation_time_s"] = n.correlation_time_s;
  json["effective_samples"] = n.effective_samples;
  return json;
}

nlohmann::json moving_json(const MovingNoise& n) {
  nlohmann::json json{{"holds", n.holds()}, {"repeated", n.repeated}};
  add_counts(n, json);
  for (std::size_t k = 0; k < (n.has_orientation ? 6u : 3u); ++k) {
    const MovingChannel& c = n.channels[k];
    json["channels"].push_back({{"sigma_m_or_rad", c.sigma},
                                {"sigma_fraction", c.sigma_fraction},
                                {"model", c.order == 2 ? "constant velocity" : "constant acceleration"},
                                {"drive", c.drive},
                                {"nis", c.nis},
                                {"share_beyond_95_percent", c.outside_95},
                                {"lag_one_correlation", c.lag_one},
                                {"correlation", c.correlation},
                                {"correlation_if_white", c.correlation_if_white},
                                {"outliers", c.outliers},
                                {"holds", c.holds()}});
  }
  return json;
}

}  // namespace

void NoiseReport::plot(const std::string& path) const {
  plot::Figure figure{.title = fmt::format("Noise, {}", moving ? "moving" : "at rest")};
  std::vector<const SensorNoise*> told;
  for (const SensorNoise& s : sensors)
    if (s.untold().empty()) told.push_back(&s);
  for (const SensorNoise* s : told) figure.panels.push_back(moving ? innovations(*s) : deviations(*s));
  figure.height_px = 100 + 210 * static_cast<int>(told.size());
  if (!moving) {
    figure.panels.push_back(allan(told, false));
    figure.panels.push_back(allan(told, true));
    if (figure.panels.back().series.empty()) figure.panels.pop_back();
    figure.height_px += 500;
  }
  plot::write_figure(figure, path);
}

void NoiseReport::print_json() const {
  nlohmann::json json{{"recording", source}, {"moving", moving}};
  if (!out.empty()) json["written"] = out;
  for (const SensorNoise& s : sensors) {
    nlohmann::json entry{{"sensor", s.name}, {"on_catheter", s.sensor != nullptr}};
    if (!s.untold().empty()) {
      entry["cannot_be_told"] = s.untold();
    } else {
      entry["position_sigma_mm"] = numbers(s.position_m2().diagonal().cwiseSqrt() * kMillimetresPerMetre);
      const bool turns = s.rest ? s.rest->has_orientation : s.moving->has_orientation;
      if (turns) entry["orientation_sigma_deg"] = numbers(s.rotation_rad2().cwiseSqrt() * kDegrees);
      entry["sigma_fraction"] = s.sigma_fraction();
      entry.update(s.rest ? rest_json(*s.rest) : moving_json(*s.moving));
    }
    json["sensors"].push_back(std::move(entry));
  }
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace palpate::app
