// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <palpate/recording/catheter_estimator.hpp>
#include <palpate/recording/catheter_file.hpp>

namespace palpate {
namespace {

/// Beside the force: what is estimated, how fast it may drift, and what is only considered.
void read_parameters(const TomlTable& table, ObserverOptions& options) {
  if (table.has("state") && !choose_state(table.texts("state"), options))
    table.refuse("state", "\"force\", to which \"stiffness\", \"precurvature\" may be added");
  options.free_torsion = table.choice<bool>("torsion", {{"tied", false}, {"free", true}}, options.free_torsion);
  options.consider_uncertainty = table.flag("consider", options.consider_uncertainty);
  options.stiffness_rate_per_s =
      0.01 * table.number("stiffness_rate_percent_per_s", {1e-300, 1000.0, "%/s, more than 0, at most 1000"},
                          100.0 * options.stiffness_rate_per_s);
  options.stiffness_drift_per_sqrt_s = 0.01 * table.number("stiffness_drift_percent_per_sqrt_s",
                                                           {1e-300, 1000.0, "%/sqrt(s), more than 0, at most 1000"},
                                                           100.0 * options.stiffness_drift_per_sqrt_s);
  options.precurvature_drift_per_m_sqrt_s =
      table.number("precurvature_drift_per_m_sqrt_s", {1e-300, 1000.0, "1/(m sqrt(s)), more than 0, at most 1000"},
                   options.precurvature_drift_per_m_sqrt_s);
}

void read_choices(const TomlTable& table, ObserverOptions& options) {
  options.method = table.choice<Method>(
      "method", {{"ekf", Method::kEkf}, {"iekf", Method::kIekf}, {"iaekf", Method::kIaekf}, {"ukf", Method::kUkf}},
      options.method);
  options.measurement = table.choice<MeasurementKind>(
      "measurement", {{"poses", MeasurementKind::kPoses}, {"tip_and_curvature", MeasurementKind::kTipAndCurvature}},
      options.measurement);
  options.force_model = table.choice<ForceMotion>("force_model",
                                                  {{"random_walk", ForceMotion::kRandomWalk},
                                                   {"gauss_markov", ForceMotion::kGaussMarkov},
                                                   {"constant_velocity", ForceMotion::kConstantVelocity},
                                                   {"rhythm", ForceMotion::kRhythm}},
                                                  options.force_model);
}

/// How the force moves: [estimator] as far as the motion model goes.
void read_motion(const TomlTable& table, ObserverOptions& options) {
  options.force_rate_N_per_sqrt_s =
      table.number("force_rate_N_per_sqrt_s", {0.0, 100.0, "N/sqrt(s), 0 (found from the data) to 100"},
                   options.force_rate_N_per_sqrt_s);
  if (options.force_rate_N_per_sqrt_s > 0.0 && options.force_model != ForceMotion::kRandomWalk)
    table.refuse("force_rate_N_per_sqrt_s", "force_model = \"random_walk\" beside it, or 0 (found from the data)");
  options.force_acceleration_N_per_s_sqrt_s =
      table.number("force_acceleration_N_per_s_sqrt_s", {0.0, 1000.0, "N/(s sqrt(s)), 0 (found from the data) to 1000"},
                   options.force_acceleration_N_per_s_sqrt_s);
  if (options.force_acceleration_N_per_s_sqrt_s > 0.0 && options.force_model != ForceMotion::kConstantVelocity &&
      options.force_model != ForceMotion::kRhythm)
    table.refuse("force_acceleration_N_per_s_sqrt_s",
                 "force_model = \"constant_velocity\" or \"rhythm\" beside it, or 0 (found from the data)");
  options.force_memory_s = table.number("force_memory_s", {1e-3, 1e4, "seconds, 0.001..10000"}, options.force_memory_s);
  options.disturbance_rms_N =
      table.number("disturbance_rms_N", {0.0, 1000.0, "a force in N, 0 (none) to 1000"}, options.disturbance_rms_N);
  options.disturbance_memory_s =
      table.number("disturbance_memory_s", {1e-3, 1e4, "seconds, 0.001..10000"}, options.disturbance_memory_s);
}

/// Where the filter starts, how long it tries and what it refuses.
void read_limits(const TomlTable& table, ObserverOptions& options) {
  options.initial_force_sigma_N =
      table.number("initial_force_sigma_N", {1e-12, 1000.0, "a force in N, more than 0, at most 1000"},
                   options.initial_force_sigma_N);
  options.max_iterations = table.integer("max_iterations", {1.0, 100.0, "an integer, 1..100"}, options.max_iterations);
  options.adaptation_window =
      table.integer("adaptation_window", {5.0, 1000.0, "a number of frames, 5..1000"}, options.adaptation_window);
  options.outlier_probability = table.number(
      "outlier_probability", {1e-300, 0.1, "a probability, more than 0, at most 0.1"}, options.outlier_probability);
  options.jump_probability = table.number("jump_probability", {1e-300, 0.1, "a probability, more than 0, at most 0.1"},
                                          options.jump_probability);
  options.noise_tail_degrees =
      table.number("noise_tail_degrees", {0.0, 100.0, "0 (Gaussian noise) or 1..100"}, options.noise_tail_degrees);
  if (options.noise_tail_degrees > 0.0 && options.noise_tail_degrees < 1.0)
    table.refuse("noise_tail_degrees", "0 (Gaussian noise) or 1..100");
}

}  // namespace

bool choose_state(std::span<const std::string> names, ObserverOptions& options) {
  const auto has = [&](std::string_view name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  const bool known = std::all_of(names.begin(), names.end(), [](const std::string& name) {
    return name == "force" || name == "stiffness" || name == "precurvature";
  });
  if (!known || !has("force")) return false;
  options.estimate_stiffness = has("stiffness");
  options.estimate_precurvature = has("precurvature");
  return true;
}

void read_estimator(const TomlTable& root, ObserverOptions& options) {
  const auto table = root.table("estimator", {"method",
                                              "measurement",
                                              "state",
                                              "force_model",
                                              "force_rate_N_per_sqrt_s",
                                              "force_acceleration_N_per_s_sqrt_s",
                                              "force_memory_s",
                                              "disturbance_rms_N",
                                              "disturbance_memory_s",
                                              "initial_force_sigma_N",
                                              "max_iterations",
                                              "adaptation_window",
                                              "outlier_probability",
                                              "jump_probability",
                                              "noise_tail_degrees",
                                              "torsion",
                                              "consider",
                                              "stiffness_rate_percent_per_s",
                                              "stiffness_drift_percent_per_sqrt_s",
                                              "precurvature_drift_per_m_sqrt_s"});
  if (!table) return;
  read_choices(*table, options);
  read_parameters(*table, options);
  read_motion(*table, options);
  read_limits(*table, options);
}

}  // namespace palpate
