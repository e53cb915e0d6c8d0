// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <palpate/estimation/consistency.hpp>

#include "estimate_options.hpp"
#include "report_json.hpp"

namespace palpate::app {

namespace {

nlohmann::json contact_json(const Contact& contact) {
  return {{"from_s", rounded(contact.from_s, 9)},
          {"to_s", rounded(contact.to_s, 9)},
          {"duration_s", rounded(contact.duration_s(), 6)},
          {"frames", contact.frames},
          {"mean_N", rounded(contact.mean_N(), 6)},
          {"max_N", rounded(contact.largest_N, 9)},
          {"max_at_s", rounded(contact.largest_at_s, 9)},
          {"integral_Ns", rounded(contact.integral_Ns, 6)},
          {"integral_sigma_Ns", rounded(contact.integral_sigma_Ns, 4)},
          {"bridged_s", rounded(contact.bridged_s, 4)}};
}

nlohmann::json bands_json(const ReportRun& run, const std::vector<double>& edges_g) {
  std::vector<double> edges_N;
  for (const double edge_g : edges_g) edges_N.push_back(edge_g / kGramsForcePerNewton);
  const TimeInBands bands = time_in_bands(run.sizes, edges_N);
  return {{"edges_g", edges_g},
          {"seconds", bands.seconds},
          {"not_measured_s", bands.not_measured_s},
          {"total_s", bands.total_s}};
}

/// The measured frame of the largest force; null where none was measured.
nlohmann::json peak_json(const ReportRun& run) {
  const ForceSize* peak = nullptr;
  for (const ForceSize& size : run.sizes)
    if (size.measured && (!peak || size.size_N > peak->size_N)) peak = &size;
  if (!peak) return nullptr;
  return {{"time_s", peak->time_s}, {"size_N", peak->size_N}, {"sigma_N", rounded(peak->sigma_N, 4)}};
}

nlohmann::json sensors_json(const ReportRun& run) {
  nlohmann::json out = nlohmann::json::array();
  for (const SensorShare& share : run.sensors) {
    nlohmann::json entry{{"name", share.name}, {"frames", share.frames}, {"usable", share.by_reason[0]}};
    for (std::size_t i = 1; i < kRejections; ++i)
      if (share.by_reason[i] > 0)
        entry["reasons"][std::string(describe(static_cast<Rejection>(i)))] = share.by_reason[i];
    out.push_back(std::move(entry));
  }
  return out;
}

/// How the innovations compare with what the filter claims; null where the estimate has none.
nlohmann::json innovation_json(const ReportRun& run) {
  std::size_t frames = 0, inside = 0;
  double sum = 0.0;
  std::array<std::array<double, 2>, kMaxResiduals + 1> limits{};
  for (const EstimateRow& row : run.rows) {
    if (row.dof < 1 || row.dof > kMaxResiduals || !std::isfinite(row.nis)) continue;
    auto& [low, high] = limits[static_cast<std::size_t>(row.dof)];
    if (high == 0.0) {
      low = chi_square_tail_quantile(0.975, row.dof);
      high = chi_square_tail_quantile(0.025, row.dof);
    }
    ++frames;
    inside += row.nis >= low && row.nis <= high;
    sum += row.nis / row.dof;
  }
  if (frames == 0) return nullptr;
  const auto n = static_cast<double>(frames);
  return {{"frames", frames},
          {"mean_nis_per_dof", rounded(sum / n, 4)},
          {"share_inside_95", rounded(static_cast<double>(inside) / n, 4)}};
}

std::string_view name_of(SensorKind kind) {
  return kind == SensorKind::kPose ? "pose" : kind == SensorKind::kPose5 ? "pose5" : "position";
}

nlohmann::json triple(const Vector3d& v, int digits) {
  return {rounded(v.x(), digits), rounded(v.y(), digits), rounded(v.z(), digits)};
}

}  // namespace

nlohmann::json figures_json(const ReportRun& run, const ContactRule& rule, const std::vector<double>& edges_g) {
  nlohmann::json contacts = nlohmann::json::array();
  for (const Contact& contact : find_contacts(run.sizes, rule)) contacts.push_back(contact_json(contact));
  return {{"peak", peak_json(run)},
          {"contacts", std::move(contacts)},
          {"contact_rule", in_words(rule)},
          {"bands", bands_json(run, edges_g)}};
}

nlohmann::json health_json(const ReportRun& run) {
  std::array<std::size_t, kEstimateStatuses> by_status{};
  for (const EstimateRow& row : run.rows) ++by_status[static_cast<std::size_t>(row.status)];
  nlohmann::json out{{"frames", run.rows.size()}, {"warnings", run.warnings}, {"words", run.uncertainty_words}};
  for (std::size_t i = 0; i < kEstimateStatuses; ++i)
    out["by_status"][std::string(describe(static_cast<EstimateStatus>(i)))] = by_status[i];
  out["sensors"] = sensors_json(run);
  out["innovation"] = innovation_json(run);
  out["events"] = nlohmann::json::array();
  for (const RunEvent& event : run.events)
    out["events"].push_back({{"time_s", event.time_s ? rounded(*event.time_s, 9) : nullptr}, {"text", event.text}});
  out["gaps"] = nlohmann::json::array();
  for (const RunGap& gap : run.gaps)
    out["gaps"].push_back({{"from_s", rounded(gap.from_s, 9)}, {"to_s", rounded(gap.to_s, 9)}});
  return out;
}

nlohmann::json settings_json(const ReportRun& run) {
  const Catheter& catheter = run.catheter;
  const ObserverOptions& observer = run.description.settings.observer;
  const Section& shaft = catheter.rod.first_flexible();
  nlohmann::json sensors = nlohmann::json::array();
  for (const Sensor& sensor : catheter.sensors)
    sensors.push_back({{"name", sensor.name},
                       {"kind", name_of(sensor.kind)},
                       {"arc_length_mm", rounded(sensor.arc_length_m * kMillimetresPerMetre, 6)},
                       {"noise_mm", triple(sensor.noise_m * kMillimetresPerMetre, 4)},
                       {"noise_deg", rounded(sensor.noise_rad / kRadiansPerDegree, 4)}});
  return {{"name", catheter.name},
          {"source", std::filesystem::path(run.description.catheter_source).filename().string()},
          {"text", run.description.catheter_text},
          {"length_mm", rounded(catheter.rod.length_m() * kMillimetresPerMetre, 6)},
          {"stiffness_Nm2", triple(shaft.stiffness_Nm2, 6)},
          {"stiffness_sigma_percent", rounded(100.0 * catheter.stiffness_sigma_fraction, 4)},
          {"precurvature_per_m", triple(shaft.precurvature_per_m, 5)},
          {"precurvature_sigma_per_m", triple(catheter.precurvature_sigma_per_m, 4)},
          {"sensors", std::move(sensors)},
          {"method", name_of(observer.method)},
          {"measurement", name_of(observer.measurement)},
          {"force_model", name_of(observer.force_model)},
          {"considers_uncertainty", observer.consider_uncertainty},
          {"estimates_stiffness", observer.estimate_stiffness},
          {"estimates_precurvature", observer.estimate_precurvature}};
}

}  // namespace palpate::app
