// SPDX-License-Identifier: Apache-2.0
#include "estimate_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <palpate/evaluation/uncertainty_words.hpp>
#include <palpate/math/units.hpp>
#include <palpate/plot/plot.hpp>

#include "estimate_options.hpp"
#include "uncertainty_json.hpp"

namespace palpate::app {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

nlohmann::json to_array(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::string to_text(const Vector3d& v, int digits) {
  return fmt::format("({:.{}f}, {:.{}f}, {:.{}f})", v.x(), digits, v.y(), digits, v.z(), digits);
}

/// The band of frames not used grows without end. Where it leaves what the others need it is left out: cut off it would
/// look like a bound, whole it would flatten the rest of the picture.
void leave_out_wide_bands(const std::vector<bool>& updated, plot::Series& force) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < updated.size(); ++i) {
    if (!updated[i]) continue;
    low = std::min(low, force.lower[i]);
    high = std::max(high, force.upper[i]);
  }
  if (!(low < high)) return;
  const double room = 0.25 * (high - low);
  for (std::size_t i = 0; i < updated.size(); ++i)
    if (!updated[i] && (force.lower[i] < low - room || force.upper[i] > high + room))
      force.lower[i] = force.upper[i] = kNaN;
}

nlohmann::json average_json(const ForceAverage& average, const Catheter& catheter) {
  nlohmann::json json{{"from_s", average.from_s()}, {"to_s", average.to_s()}, {"frames", average.frames()}};
  if (average.frames() == 0) return json;
  const Matrix3d covariance = average.covariance_base_N2();
  json["force_tip_N"] = to_array(average.force_tip_N());
  json["force_base_N"] = to_array(average.force_base_N());
  json["sigma_base_N"] = to_array(covariance.diagonal().cwiseSqrt());
  if (!catheter.rod.has_distributed_load()) return json;
  const Vector3d down = catheter.rod.distributed_load_base_N_per_m.normalized();
  json["along_gravity_N"] = down.dot(average.force_base_N());
  json["along_gravity_sigma_N"] = std::sqrt(down.dot(covariance * down));
  return json;
}

}  // namespace

void EstimateReport::add(const Estimate& estimate, std::size_t readings) {
  summary_.add(estimate, readings);
  if (average_) average_->add(estimate);
  times_s_.push_back(estimate.time_s);
  force_N_.push_back(estimate.force_tip_N);
  sigma_N_.emplace_back(estimate.covariance_tip_N2.diagonal().cwiseSqrt());
  updated_.push_back(estimate.used != 0);
}

void EstimateReport::plot(const std::string& path, const std::string& title) const {
  plot::Figure figure{.title = title};
  const char* labels[] = {"Fx along d1 [N]", "Fy along d2 [N]", "Fz along d3 [N]"};
  const bool any_held = std::find(updated_.begin(), updated_.end(), false) != updated_.end();
  for (int axis = 0; axis < 3; ++axis) {
    plot::Series force{.label = "estimate", .x = times_s_, .band_label = "95 % interval"};
    plot::Series held{.label = "predicted, not measured", .x = times_s_, .style = plot::Style::kPoints};
    for (std::size_t i = 0; i < times_s_.size(); ++i) {
      const double value_N = force_N_[i](axis), half_width_N = 1.959964 * sigma_N_[i](axis);
      force.y.push_back(value_N);
      force.lower.push_back(value_N - half_width_N);
      force.upper.push_back(value_N + half_width_N);
      held.y.push_back(updated_[i] ? kNaN : value_N);
    }
    leave_out_wide_bands(updated_, force);
    plot::Panel panel{.x_label = "time [s]", .y_label = labels[axis], .series = {std::move(force)}};
    if (any_held) panel.series.push_back(std::move(held));
    figure.panels.push_back(std::move(panel));
  }
  plot::write_figure(figure, path);
}

void EstimateReport::print(const Catheter& catheter, const ObserverOptions& options, const std::string& out,
                           bool json) {
  const RunSummary summary = summary_.finish();
  if (json) return print_json(summary, catheter, options, out);
  fmt::print("{} frames, {:.3f} s to {:.3f} s, {} on {}, force model {}{}\n", summary.frames, summary.first_time_s,
             summary.last_time_s, name_of(options.method), name_of(options.measurement), name_of(options.force_model),
             smoothed_ ? ", smoothed" : "");
  print_counts(summary);
  print_tare();
  print_figures(summary);
  fmt::print("{}", in_words(summary.uncertainty, options));
  print_average(catheter);
  fmt::print("written: {}\n", out);
}

void EstimateReport::print_counts(const RunSummary& s) const {
  for (std::size_t i = 0; i < kEstimateStatuses; ++i)
    if (s.by_status[i] > 0) fmt::print("  {:<16}{:>8}\n", describe(static_cast<EstimateStatus>(i)), s.by_status[i]);
  const std::size_t absent = s.readings_by_reason[static_cast<std::size_t>(Rejection::kAbsent)];
  if (absent > 0) fmt::print("  sensors not in a frame: {}\n", absent);
  for (std::size_t i = 1; i < kRejections; ++i)
    if (i != static_cast<std::size_t>(Rejection::kAbsent) && s.readings_by_reason[i] > 0)
      fmt::print("  readings not used: {}: {}\n", describe(static_cast<Rejection>(i)), s.readings_by_reason[i]);
  const std::pair<const char*, std::size_t> rows[] = {{"duplicate rows", recording_.duplicate_rows},
                                                      {"frames whose time stood still", s.time_stood_still},
                                                      {"frames whose time stepped back", s.time_stepped_back},
                                                      {"frames whose time was not finite", s.time_not_finite},
                                                      {"times the clock was taken up anew", s.clock_resynchronised}};
  for (const auto& [what, count] : rows)
    if (count > 0) fmt::print("  {}: {}\n", what, count);
}

void EstimateReport::print_tare() const {
  if (!tare_) return;
  fmt::print("tare from {} frames: base moved {} mm, turned {} deg; precurvature changed by {} 1/m\n", tare_->frames,
             to_text(tare_->base_shift_m * kMillimetresPerMetre, 3),
             to_text(tare_->base_rotation_rad / kRadiansPerDegree, 3), to_text(tare_->precurvature_change_per_m, 3));
  if (tare_->outliers > 0) fmt::print("  {} readings left out as outliers\n", tare_->outliers);
  fmt::print("  positions off by {:.3f} mm before, {:.3f} mm after\n", tare_->residual_before_m * kMillimetresPerMetre,
             tare_->residual_after_m * kMillimetresPerMetre);
}

void EstimateReport::print_figures(const RunSummary& s) const {
  if (s.by_status[static_cast<std::size_t>(EstimateStatus::kUpdated)] == 0) {
    fmt::print("no frame was used: the force is the one assumed before the first frame, with its sigma\n");
    return;
  }
  fmt::print("force in tip components (d1, d2, d3): mean {} mN, median sigma {} mN\n",
             to_text(s.mean_force_tip_N * 1e3, 2), to_text(s.median_sigma_N * 1e3, 2));
  fmt::print("largest force {:.4f} N ({:.1f} g)\n", s.largest_force_N, s.largest_force_N * kGramsForcePerNewton);
  fmt::print("innovation chi-square per degree of freedom {:.2f} (1 is as claimed)\n", s.mean_nis_per_dof);
  fmt::print("convergence index: r^T S r {:.3g} (the paper's, mixed units), r^T S^-1 r {:.3g}\n", s.mean_rho_paper,
             s.mean_rho_normalised);
  fmt::print("rod solutions a frame: median {:.0f}, most {}\n", s.median_evaluations, s.most_evaluations);
}

void EstimateReport::print_average(const Catheter& catheter) const {
  if (!average_) return;
  fmt::print("mean over {} to {} s, {} frames", average_->from_s(), average_->to_s(), average_->frames());
  if (average_->frames() == 0) return fmt::print(": none was used\n");
  const Matrix3d covariance = average_->covariance_base_N2();
  const Vector3d force_base = average_->force_base_N();
  fmt::print("; base components {} N, sigma {} N\n", to_text(force_base, 4),
             to_text(covariance.diagonal().cwiseSqrt(), 4));
  if (!catheter.rod.has_distributed_load()) return;
  const Vector3d down = catheter.rod.distributed_load_base_N_per_m.normalized();
  fmt::print("  along gravity {:.4f} N, sigma {:.4f} N; size {:.4f} N\n", down.dot(force_base),
             std::sqrt(down.dot(covariance * down)), force_base.norm());
}

void EstimateReport::print_json(const RunSummary& s, const Catheter& catheter, const ObserverOptions& options,
                                const std::string& out) const {
  nlohmann::json json{
      {"recording", recording_.source},
      {"catheter", catheter.name},
      {"estimate", out},
      {"method", name_of(options.method)},
      {"measurement", name_of(options.measurement)},
      {"force_model", name_of(options.force_model)},
      {"smoothed", smoothed_},
      {"frames", s.frames},
      {"first_time_s", s.first_time_s},
      {"last_time_s", s.last_time_s},
      {"mean_force_tip_N", to_array(s.mean_force_tip_N)},
      {"median_sigma_N", to_array(s.median_sigma_N)},
      {"last",
       {{"force_tip_N", to_array(s.last_force_tip_N)},
        {"force_base_N", to_array(s.last_force_base_N)},
        {"sigma_N", to_array(s.last_sigma_N)}}},
      {"largest_force_N", s.largest_force_N},
      {"nis_per_dof", s.mean_nis_per_dof},
      {"convergence_index", {{"rho_paper", s.mean_rho_paper}, {"rho_normalised", s.mean_rho_normalised}}},
      {"evaluations", {{"median", s.median_evaluations}, {"most", s.most_evaluations}}},
      {"rejected_rows",
       {{"duplicate", recording_.duplicate_rows},
        {"time_stands_still", s.time_stood_still},
        {"time_steps_back", s.time_stepped_back},
        {"time_not_finite", s.time_not_finite},
        {"clock_resynchronised", s.clock_resynchronised}}}};
  for (std::size_t i = 0; i < kEstimateStatuses; ++i)
    json["frames_by_status"][std::string(describe(static_cast<EstimateStatus>(i)))] = s.by_status[i];
  json["sensors_not_in_a_frame"] = s.readings_by_reason[static_cast<std::size_t>(Rejection::kAbsent)];
  for (std::size_t i = 1; i < kRejections; ++i)
    if (i != static_cast<std::size_t>(Rejection::kAbsent))
      json["readings_not_used"][std::string(describe(static_cast<Rejection>(i)))] = s.readings_by_reason[i];
  add_uncertainty(s.uncertainty, options, json);
  if (tare_)
    json["tare"] = {{"frames", tare_->frames},
                    {"outliers", tare_->outliers},
                    {"largest_change_sigmas", tare_->largest_change_sigmas},
                    {"base_shift_mm", to_array(tare_->base_shift_m * kMillimetresPerMetre)},
                    {"base_rotation_deg", to_array(tare_->base_rotation_rad / kRadiansPerDegree)},
                    {"precurvature_change_per_m", to_array(tare_->precurvature_change_per_m)},
                    {"residual_before_mm", tare_->residual_before_m * kMillimetresPerMetre},
                    {"residual_after_mm", tare_->residual_after_m * kMillimetresPerMetre}};
  if (average_) json["average"] = average_json(*average_, catheter);
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace palpate::app
