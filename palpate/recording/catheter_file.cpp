// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/catheter_sensors.hpp>
#include <palpate/recording/catheter_shaft.hpp>
#include <palpate/recording/text_table.hpp>

namespace palpate {
namespace {

[[noreturn]] void refuse_line(const TextFile& file, std::size_t line, std::string_view expectation) {
  throw InputError(fmt::format("{}:{}: line '{}': expected TOML: {}", file.name, line,
                               printable(trim(file.lines[line - 1])), printable(expectation, 400)));
}

/// toml++ 3.3 has undefined behaviour where no key follows the bracket of a table header: it never sees one.
void refuse_headers_without_key(const TextFile& file) {
  constexpr std::string_view kKeyStart = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-\"'";
  for (std::size_t i = 0; i < file.lines.size(); ++i) {
    std::string_view text = trim(file.lines[i]);
    if (!text.starts_with('[')) continue;
    text = trim(text.substr(1));
    if (text.starts_with('[')) text = trim(text.substr(1));
    if (text.empty() || kKeyStart.find(text.front()) == std::string_view::npos)
      refuse_line(file, i + 1, "[NAME] or [[NAME]]");
  }
}

toml::table parse_toml(const TextFile& file) {
  refuse_headers_without_key(file);
  const std::string text = fmt::format("{}\n", fmt::join(file.lines, "\n"));
  try {
    return toml::parse(text, file.name);
  } catch (const toml::parse_error& error) {
    const auto line = std::clamp<std::size_t>(error.source().begin.line, 1, file.lines.size());
    refuse_line(file, line, error.description());
  }
}

void read_tendon(const TomlTable& root, Tendon& tendon, std::vector<std::string>& warnings) {
  const auto table = root.table("tendon", {"model", "offset_mm", "moment_sigma_percent"});
  if (!table) return;
  tendon.present = true;
  tendon.model = table->choice<TendonModel>(
      "model", {{"couple", TendonModel::kCouple}, {"end_moment", TendonModel::kEndMoment}}, TendonModel::kCouple);
  tendon.offset_m =
      table->number("offset_mm", {1e-6, 100.0, "a length in mm, more than 0, at most 100"}, 0.0) * kMetresPerMillimetre;
  tendon.moment_sigma_fraction = 0.01 * table->number("moment_sigma_percent", {0.0, 100.0, "percent, 0..100"}, 0.0);
  warn_not_acted_on(*table, "moment_sigma_percent", tendon.moment_sigma_fraction > 0.0,
                    "the force's sigma does not contain it", warnings);
}

void read_state(const TomlTable& table, ObserverOptions& options, std::vector<std::string>& warnings) {
  if (!table.has("state")) return;
  const std::vector<std::string> names = table.texts("state");
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  const bool known = std::all_of(names.begin(), names.end(), [](const std::string& name) {
    return name == "force" || name == "stiffness" || name == "precurvature";
  });
  if (!known || !has("force"))
    table.refuse("state", "\"force\", to which \"stiffness\", \"precurvature\" may be added");
  options.estimate_stiffness = has("stiffness");
  options.estimate_precurvature = has("precurvature");
  warn_not_acted_on(table, "state", options.estimate_stiffness || options.estimate_precurvature,
                    "only the force is estimated", warnings);
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

void read_estimator(const TomlTable& root, ObserverOptions& options, std::vector<std::string>& warnings) {
  const auto table =
      root.table("estimator", {"method", "measurement", "state", "force_model", "force_rate_N_per_sqrt_s",
                               "force_acceleration_N_per_s_sqrt_s", "force_memory_s", "disturbance_rms_N",
                               "disturbance_memory_s", "initial_force_sigma_N", "max_iterations", "adaptation_window",
                               "outlier_probability", "jump_probability", "noise_tail_degrees"});
  if (!table) return;
  read_choices(*table, options);
  read_state(*table, options, warnings);
  read_motion(*table, options);
  options.initial_force_sigma_N =
      table->number("initial_force_sigma_N", {1e-12, 1000.0, "a force in N, more than 0, at most 1000"},
                    options.initial_force_sigma_N);
  options.max_iterations = table->integer("max_iterations", {1.0, 100.0, "an integer, 1..100"}, options.max_iterations);
  options.adaptation_window =
      table->integer("adaptation_window", {5.0, 1000.0, "a number of frames, 5..1000"}, options.adaptation_window);
  options.outlier_probability = table->number(
      "outlier_probability", {1e-300, 0.1, "a probability, more than 0, at most 0.1"}, options.outlier_probability);
  options.jump_probability = table->number("jump_probability", {1e-300, 0.1, "a probability, more than 0, at most 0.1"},
                                           options.jump_probability);
  options.noise_tail_degrees =
      table->number("noise_tail_degrees", {0.0, 100.0, "0 (Gaussian noise) or 1..100"}, options.noise_tail_degrees);
  if (options.noise_tail_degrees > 0.0 && options.noise_tail_degrees < 1.0)
    table->refuse("noise_tail_degrees", "0 (Gaussian noise) or 1..100");
}

void read_reference(const TomlTable& root, ReferenceInterval& reference) {
  const auto table = root.table("reference", {"from_s", "to_s", "shape"});
  if (!table) return;
  const NumberRange time = {-1e15, 1e15, "a time of the recording in seconds"};
  reference.given = true;
  reference.from_s = table->number("from_s", time);
  reference.to_s = table->number("to_s", time);
  if (!(reference.to_s > reference.from_s)) table->refuse("to_s", "a time later than from_s");
  reference.straight = table->choice<bool>("shape", {{"unloaded", false}, {"straight", true}}, false);
}

CatheterFile read_root(const TomlTable& root) {
  root.number("schema", {1.0, 1.0, "1, the schema this program reads"}, 1.0);
  CatheterFile file;
  read_shaft(root, file.catheter, file.warnings);
  read_tendon(root, file.catheter.tendon, file.warnings);
  read_sensors(root, file.catheter, file.warnings);
  read_estimator(root, file.observer, file.warnings);
  if (const auto recording = root.table("recording", {"ignore_sensors"})) {
    file.ignore_sensors = recording->texts("ignore_sensors");
  }
  read_reference(root, file.reference);
  return file;
}

}  // namespace

CatheterFile read_catheter_file(const std::filesystem::path& path) {
  const TextFile text = read_text_file(path);
  const toml::table table = parse_toml(text);
  CatheterFile file = read_root(
      TomlTable(table, "", text.name,
                {"schema", "catheter", "tendon", "gravity", "base", "sensor", "estimator", "recording", "reference"}));
  try {
    file.catheter.validate();
    file.observer.validate();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", text.name, error.what()));
  }
  return file;
}

}  // namespace palpate
