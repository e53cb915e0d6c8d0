// SPDX-License-Identifier: Apache-2.0
#include "identify_delay_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <palpate/plot/plot.hpp>

namespace palpate::app {

std::vector<std::string> warnings_of(const DelayReport& report) {
  std::vector<std::string> warnings;
  const DelayFit& fit = report.fit;
  if (fit.ambiguous)
    warnings.push_back(fmt::format(
        "a delay of {:+.4f} s explains {:.1f} % of the force, that of {:+.4f} s explains {:.1f} %: a rhythm "
        "looks alike one period later; choose a smaller --max-delay if you know better, or press once "
        "without rhythm",
        fit.rival->delay_s, 100.0 * fit.rival->explained, fit.delay_s, 100.0 * fit.explained));
  if (std::abs(fit.gain - 1.0) > std::max(0.1, 4.0 * fit.gain_sigma))
    warnings.push_back(fmt::format(
        "the tracker's force is {:.2f} times the force sensor's: is the catheter's stiffness right?", fit.gain));
  if (fit.explained < 0.7)
    warnings.push_back(
        fmt::format("the force sensor explains only {:.0f} % of the tracker's force", 100.0 * fit.explained));
  if (!report.smoothed)
    warnings.push_back(fmt::format(
        "{}: a delay from an estimate holds the lag of its filter, unless it was made with --smooth", report.tracker));
  return warnings;
}

void DelayReport::print() const {
  fmt::print("{} against {}: {} samples compared, {}\n", tracker, sensor, fit.used,
             smoothed ? "the tracker's force smoothed, without lag" : "the estimate as it is");
  fmt::print(
      "  delay            {:+.4f} s +- {:.4f} s (one sigma): the tracker's time stamps are {} the force sensor's\n",
      fit.delay_s, fit.sigma_s, fit.delay_s > 0.0 ? "later than" : "earlier than");
  if (earlier_s != 0.0)
    fmt::print("  delay_s in all   {:+.4f} s, with the {:+.4f} s of the catheter file\n", earlier_s + fit.delay_s,
               earlier_s);
  fmt::print("  gain             {:.4f} +- {:.4f}\n", fit.gain, fit.gain_sigma);
  fmt::print("  offset           ({:.4f}, {:.4f}, {:.4f}) N, tracker - force sensor\n", fit.offset_N.x(),
             fit.offset_N.y(), fit.offset_N.z());
  fmt::print("  residual         {:.4f} N rms an axis, independent every {:.3f} s; {:.1f} % of the force explained\n",
             fit.rms_N, fit.correlation_time_s, 100.0 * fit.explained);
  if (fit.rival)
    fmt::print("  next best        {:+.4f} s, {:.1f} % explained\n", fit.rival->delay_s, 100.0 * fit.rival->explained);
  if (!out.empty()) fmt::print("written: {}\n", out);
}

void DelayReport::print_json() const {
  nlohmann::json json{{"tracker", tracker},
                      {"force_sensor", sensor},
                      {"smoothed", smoothed},
                      {"delay_s", fit.delay_s},
                      {"sigma_s", fit.sigma_s},
                      {"delay_with_catheter_file_s", earlier_s + fit.delay_s},
                      {"gain", fit.gain},
                      {"gain_sigma", fit.gain_sigma},
                      {"offset_N", {fit.offset_N.x(), fit.offset_N.y(), fit.offset_N.z()}},
                      {"rms_N", fit.rms_N},
                      {"explained", fit.explained},
                      {"correlation_time_s", fit.correlation_time_s},
                      {"samples", fit.used},
                      {"ambiguous", fit.ambiguous}};
  if (fit.rival) json["next_best"] = {{"delay_s", fit.rival->delay_s}, {"explained", fit.rival->explained}};
  if (!out.empty()) json["written"] = out;
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

void DelayReport::plot(const std::string& path) const {
  plot::Figure figure{.title = fmt::format("Delay {:+.1f} ms +- {:.1f} ms", 1e3 * fit.delay_s, 1e3 * fit.sigma_s),
                      .height_px = 1000};
  const char* labels[] = {"Fx [N]", "Fy [N]", "Fz [N]"};
  for (int axis = 0; axis < 3; ++axis) {
    plot::Series tracker_force{.label = "tracker"};
    for (const TimedForce& sample : felt) {
      tracker_force.x.push_back(sample.time_s);
      tracker_force.y.push_back(sample.force_N(axis));
    }
    plot::Series sensor_force{.label = "force sensor, shifted and scaled", .x = fit.times_s};
    for (const Vector3d& force_N : fit.sensor_N) sensor_force.y.push_back(force_N(axis));
    figure.panels.push_back({.x_label = "tracker's time [s]",
                             .y_label = labels[axis],
                             .series = {std::move(tracker_force), std::move(sensor_force)}});
  }
  plot::Series scan{.x = fit.scan_delay_s};
  for (const double share : fit.scan_explained) scan.y.push_back(100.0 * share);
  figure.panels.push_back({.title = "share of the force that is explained",
                           .x_label = "delay [s]",
                           .y_label = "[%]",
                           .series = {std::move(scan)}});
  plot::write_figure(figure, path);
}

}  // namespace palpate::app
