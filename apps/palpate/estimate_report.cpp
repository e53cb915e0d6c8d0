// SPDX-License-Identifier: Apache-2.0
#include "estimate_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <palpate/math/units.hpp>
#include <palpate/plot/plot.hpp>

namespace palpate::app {

namespace {

const char* name_of(Method method) {
  switch (method) {
    case Method::kEkf:
      return "ekf";
    case Method::kIekf:
      return "iekf";
    case Method::kIaekf:
      return "iaekf";
    case Method::kUkf:
      return "ukf";
  }
  return "";
}

const char* name_of(MeasurementKind kind) { return kind == MeasurementKind::kPoses ? "poses" : "tip_and_curvature"; }

nlohmann::json to_array(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

void EstimateReport::add(const Estimate& estimate, std::size_t readings) {
  summary_.add(estimate, readings);
  times_s_.push_back(estimate.time_s);
  force_N_.push_back(estimate.force_tip_N);
  sigma_N_.push_back(estimate.covariance_tip_N2.diagonal().cwiseSqrt());
}

void EstimateReport::plot(const std::string& path, const std::string& title) const {
  plot::Figure figure{.title = title};
  const char* labels[] = {"Fx along d1 [N]", "Fy along d2 [N]", "Fz along d3 [N]"};
  for (int axis = 0; axis < 3; ++axis) {
    plot::Series series{.label = axis == 0 ? "estimate" : "", .x = times_s_, .band_label = axis == 0 ? "95 % interval" : ""};
    for (std::size_t i = 0; i < times_s_.size(); ++i) {
      const double force = force_N_[i](axis), half_width = 1.959964 * sigma_N_[i](axis);
      series.y.push_back(force);
      series.lower.push_back(force - half_width);
      series.upper.push_back(force + half_width);
    }
    figure.panels.push_back({.x_label = "time [s]", .y_label = labels[axis], .series = {std::move(series)}});
  }
  plot::write_figure(figure, path);
}

void EstimateReport::print(const Catheter& catheter, const ObserverOptions& options, const std::string& out, bool json) {
  const RunSummary summary = summary_.finish();
  if (json)
    print_json(summary, catheter, options, out);
  else
    print_text(summary, options, out);
}

void EstimateReport::print_text(const RunSummary& s, const ObserverOptions& options, const std::string& out) const {
  fmt::print("{} frames, {:.3f} s to {:.3f} s, {} on {}\n", s.frames, s.first_time_s, s.last_time_s, name_of(options.method), name_of(options.measurement));
  for (std::size_t i = 0; i < kEstimateStatuses; ++i)
    if (s.by_status[i] > 0) fmt::print("  {:<16}{:>8}\n", describe(static_cast<EstimateStatus>(i)), s.by_status[i]);
  for (std::size_t i = 1; i < kRejections; ++i)
    if (s.readings_by_reason[i] > 0) fmt::print("  readings not used: {}: {}\n", describe(static_cast<Rejection>(i)), s.readings_by_reason[i]);
  const std::pair<const char*, std::size_t> rows[] = {{"duplicate rows", recording_.duplicate_rows},
                                                      {"frames whose time stood still", s.time_stood_still},
                                                      {"frames whose time stepped back", s.time_stepped_back},
                                                      {"frames whose time was not finite", s.time_not_finite},
                                                      {"times the clock was taken up anew", s.clock_resynchronised}};
  for (const auto& [what, count] : rows)
    if (count > 0) fmt::print("  {}: {}\n", what, count);
  if (tare_) {
    const Vector3d shift = tare_->base_shift_m * kMillimetresPerMetre, turn = tare_->base_rotation_rad / kRadiansPerDegree;
    const Vector3d& u = tare_->precurvature_change_per_m;
    fmt::print("tare from {} frames: base moved ({:.3f}, {:.3f}, {:.3f}) mm, turned ({:.3f}, {:.3f}, {:.3f}) deg; "
               "precurvature changed by ({:.3f}, {:.3f}, {:.3f}) 1/m; positions off by {:.3f} mm before, {:.3f} mm after\n",
               tare_->frames, shift.x(), shift.y(), shift.z(), turn.x(), turn.y(), turn.z(), u.x(), u.y(), u.z(),
               tare_->residual_before_m * kMillimetresPerMetre, tare_->residual_after_m * kMillimetresPerMetre);
  }
  const Vector3d mean = s.mean_force_tip_N * 1e3, sigma = s.median_sigma_N * 1e3;
  fmt::print("force in tip components (d1, d2, d3): mean ({:.2f}, {:.2f}, {:.2f}) mN, median sigma ({:.2f}, {:.2f}, {:.2f}) mN\n", mean.x(),
             mean.y(), mean.z(), sigma.x(), sigma.y(), sigma.z());
  fmt::print("largest force {:.4f} N ({:.1f} g); innovation chi-square per degree of freedom {:.2f} (1 is as claimed)\n",
             s.largest_force_N, s.largest_force_N * kGramsForcePerNewton, s.mean_nis_per_dof);
  fmt::print("convergence index: rho = r^T S r {:.3g} (paper, mixed units), r^T S^-1 r {:.3g}; rod solutions a frame: median {:.0f}, most {}\n",
             s.mean_rho_paper, s.mean_rho_normalised, s.median_evaluations, s.most_evaluations);
  fmt::print("written: {}\n", out);
}

void EstimateReport::print_json(const RunSummary& s, const Catheter& catheter, const ObserverOptions& options,
                                const std::string& out) const {
  nlohmann::json json{{"recording", recording_.source},
                      {"catheter", catheter.name},
                      {"estimate", out},
                      {"method", name_of(options.method)},
                      {"measurement", name_of(options.measurement)},
                      {"frames", s.frames},
                      {"first_time_s", s.first_time_s},
                      {"last_time_s", s.last_time_s},
                      {"mean_force_tip_N", to_array(s.mean_force_tip_N)},
                      {"median_sigma_N", to_array(s.median_sigma_N)},
                      {"last", {{"force_tip_N", to_array(s.last_force_tip_N)}, {"force_base_N", to_array(s.last_force_base_N)}, {"sigma_N", to_array(s.last_sigma_N)}}},
                      {"largest_force_N", s.largest_force_N},
                      {"nis_per_dof", s.mean_nis_per_dof},
                      {"convergence_index", {{"rho_paper", s.mean_rho_paper}, {"rho_normalised", s.mean_rho_normalised}}},
                      {"evaluations", {{"median", s.median_evaluations}, {"most", s.most_evaluations}}}};
  for (std::size_t i = 0; i < kEstimateStatuses; ++i)
    json["frames_by_status"][std::string(describe(static_cast<EstimateStatus>(i)))] = s.by_status[i];
  for (std::size_t i = 1; i < kRejections; ++i)
    json["readings_not_used"][std::string(describe(static_cast<Rejection>(i)))] = s.readings_by_reason[i];
  json["rejected_rows"] = {{"duplicate", recording_.duplicate_rows},
                           {"time_stands_still", s.time_stood_still},
                           {"time_steps_back", s.time_stepped_back},
                           {"time_not_finite", s.time_not_finite},
                           {"clock_resynchronised", s.clock_resynchronised}};
  if (tare_)
    json["tare"] = {{"frames", tare_->frames},
                    {"base_shift_mm", to_array(tare_->base_shift_m * kMillimetresPerMetre)},
                    {"base_rotation_deg", to_array(tare_->base_rotation_rad / kRadiansPerDegree)},
                    {"precurvature_change_per_m", to_array(tare_->precurvature_change_per_m)},
                    {"residual_before_mm", tare_->residual_before_m * kMillimetresPerMetre},
                    {"residual_after_mm", tare_->residual_after_m * kMillimetresPerMetre}};
  fmt::print("{}\n", json.dump(2));
}

}  // namespace palpate::app
