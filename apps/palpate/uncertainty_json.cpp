// SPDX-License-Identifier: Apache-2.0
#include "uncertainty_json.hpp"

#include <nlohmann/json.hpp>
#include <string>

namespace palpate::app {

namespace {

nlohmann::json to_array(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::json ellipsoid_json(const Matrix3d& covariance_N2) {
  const ForceEllipsoid region = force_ellipsoid(covariance_N2);
  nlohmann::json axes = nlohmann::json::array();
  for (const Vector3d axis : region.axes.colwise()) axes.push_back(to_array(axis));
  return {{"semi_axes_N", to_array(region.semi_axes_N)}, {"axes_tip", axes}};
}

void add_shaft(const UncertaintySummary& s, const ObserverOptions& options, nlohmann::json& last) {
  const ShaftEstimate& shaft = s.last_shaft;
  const auto add = [&](const char* name, double value, double sigma) {
    last[name] = value;
    last[std::string("sigma_") + name] = sigma;
  };
  if (options.estimate_stiffness) {
    add("EI1_Nm2", shaft.stiffness_Nm2.x(), shaft.stiffness_sigma_Nm2.x());
    add("EI2_Nm2", shaft.stiffness_Nm2.y(), shaft.stiffness_sigma_Nm2.y());
    if (options.free_torsion) add("GJ_Nm2", shaft.stiffness_Nm2.z(), shaft.stiffness_sigma_Nm2.z());
  }
  if (!options.estimate_precurvature) return;
  add("k1_0_per_m", shaft.precurvature_per_m.x(), shaft.precurvature_sigma_per_m.x());
  add("k2_0_per_m", shaft.precurvature_per_m.y(), shaft.precurvature_sigma_per_m.y());
}

}  // namespace

void add_uncertainty(const UncertaintySummary& s, const ObserverOptions& options, nlohmann::json& json) {
  json["state"] = nlohmann::json::array({"force"});
  if (options.estimate_stiffness) json["state"].push_back("stiffness");
  if (options.estimate_precurvature) json["state"].push_back("precurvature");
  json["consider"] = options.consider_uncertainty;
  for (std::size_t i = 0; i < kUncertaintySources; ++i)
    json["median_sigma_by_source_N"][std::string(describe(static_cast<UncertaintySource>(i)))] =
        to_array(s.median_sigma_by_source_N[i]);
  json["weakest_direction"] = {{"force_N", to_array(s.weakest.force_N)},
                               {"log_stiffness", to_array(s.weakest.log_stiffness)},
                               {"precurvature_per_m", to_array(s.weakest.precurvature_per_m)},
                               {"prior_sigmas", s.weakest.prior_sigmas}};
  json["frames_used"] = s.frames_used;
  json["frames_not_observable"] = {{"axial_force", s.hidden.axial_force},
                                   {"axial_force_shaft_straight", s.hidden.axial_force_straight},
                                   {"lateral_force", s.hidden.lateral_force},
                                   {"stiffness_scale", s.hidden.stiffness_scale},
                                   {"precurvature", s.hidden.precurvature}};
  json["last"]["ellipsoid_95"] = ellipsoid_json(s.last_covariance_tip_N2);
  json["last"]["not_observable"] = s.last_observability.all_observable() ? "" : describe(s.last_observability);
  add_shaft(s, options, json["last"]);
  if (options.estimate_stiffness)
    json["stiffness_scale"] = {{"sigma", s.last_observability.stiffness_scale_sigma},
                               {"prior_sigma", s.last_observability.stiffness_scale_prior_sigma},
                               {"rests_on_prior", s.last_observability.stiffness_rests_on_prior}};
}

}  // namespace palpate::app
