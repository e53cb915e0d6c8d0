// SPDX-License-Identifier: Apache-2.0
#include "estimate_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <palpate/math/errors.hpp>
#include <palpate/recording/text_table.hpp>
#include <vector>

namespace palpate::app {

namespace {

template <class Enum>
using Named = std::pair<std::string_view, Enum>;

constexpr std::array<Named<Method>, 4> kMethods{
    {{"ekf", Method::kEkf}, {"iekf", Method::kIekf}, {"iaekf", Method::kIaekf}, {"ukf", Method::kUkf}}};
constexpr std::array<Named<MeasurementKind>, 2> kMeasurements{
    {{"poses", MeasurementKind::kPoses}, {"tip_and_curvature", MeasurementKind::kTipAndCurvature}}};
constexpr std::array<Named<ForceMotion>, 4> kForceModels{{{"random_walk", ForceMotion::kRandomWalk},
                                                          {"constant_velocity", ForceMotion::kConstantVelocity},
                                                          {"gauss_markov", ForceMotion::kGaussMarkov},
                                                          {"rhythm", ForceMotion::kRhythm}}};

template <class Names>
void choose(std::string_view flag, const std::string& value, const Names& known,
            typename Names::value_type::second_type& out) {
  if (value.empty()) return;
  std::vector<std::string_view> names;
  for (const auto& [name, chosen] : known) {
    if (value == name) {
      out = chosen;
      return;
    }
    names.push_back(name);
  }
  throw InputError(fmt::format("{} {}: expected one of {}", flag, value, fmt::join(names, ", ")));
}

template <class Names, class Enum>
std::string_view name_in(const Names& known, Enum value) {
  for (const auto& [name, named] : known)
    if (named == value) return name;
  return "";
}

void refuse_same_file(const char* flag, const std::string& output, const std::string& other, const char* what) {
  if (output.empty() || other.empty()) return;
  std::error_code ignored;
  const bool same = std::filesystem::path(output).lexically_normal() == std::filesystem::path(other).lexically_normal();
  if (!same && !std::filesystem::equivalent(output, other, ignored)) return;
  throw InputError(fmt::format("{} {}: expected another file than {}", flag, output, what));
}

void refuse_absent_folder(const char* flag, const std::string& output) {
  std::error_code ignored;
  const std::filesystem::path folder = std::filesystem::path(output).parent_path();
  if (folder.empty() || std::filesystem::is_directory(folder, ignored)) return;
  throw InputError(fmt::format("{} {}: expected the folder {} to exist", flag, output, folder.string()));
}

}  // namespace

std::string_view name_of(Method method) { return name_in(kMethods, method); }
std::string_view name_of(MeasurementKind kind) { return name_in(kMeasurements, kind); }
std::string_view name_of(ForceMotion motion) { return name_in(kForceModels, motion); }

TimeSpan parse_time_span(std::string_view flag, const std::string& text) {
  const auto refuse = [&](const char* expected) {
    throw InputError(fmt::format("{} {}: expected {}", flag, text, expected));
  };
  const auto number = [&](std::string_view part) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc() || end != part.data() + part.size() || !std::isfinite(value))
      refuse("FROM:TO in seconds, as 0:2");
    return value;
  };
  const std::string_view whole = text;
  const std::size_t colon = whole.find(':');
  if (colon == std::string_view::npos) refuse("FROM:TO in seconds, as 0:2");
  const TimeSpan span{number(whole.substr(0, colon)), number(whole.substr(colon + 1))};
  if (!(span.to_s > span.from_s)) refuse("an end after the beginning");
  return span;
}

void check_paths(const EstimateOptions& options) {
  const auto refuse_empty = [](const char* name, const std::string& path) {
    if (path.empty()) throw InputError(fmt::format("{}: expected the name of a file, found an empty one", name));
  };
  for (const std::string& recording : options.recordings) refuse_empty("recording", recording);
  refuse_empty("--catheter", options.catheter);
  refuse_empty("--out", options.out);
  for (const auto& [flag, output] :
       {std::pair{"--out", &options.out}, {"--plot", &options.plot}, {"--budget", &options.budget}}) {
    for (const std::string& recording : options.recordings) refuse_same_file(flag, *output, recording, "the recording");
    refuse_same_file(flag, *output, options.catheter, "the catheter file");
    refuse_same_file(flag, *output, options.tendon, "the tendon CSV");
    refuse_absent_folder(flag, *output);
  }
  refuse_same_file("--plot", options.plot, options.out, "--out");
  refuse_same_file("--budget", options.budget, options.out, "--out");
  refuse_same_file("--budget", options.budget, options.plot, "--plot");
  const std::string extension = std::filesystem::path(options.plot).extension().string();
  if (!options.plot.empty() && extension != ".svg" && extension != ".png")
    throw InputError(fmt::format("--plot {}: expected a file name that ends in .svg or .png", options.plot));
}

namespace {

void apply_state(const std::string& state, ObserverOptions& observer) {
  if (state.empty()) return;
  std::vector<std::string> names;
  for (const std::string_view name : split(state, ',')) names.emplace_back(name);
  if (!choose_state(names, observer))
    throw InputError(
        fmt::format("--state {}: expected force, to which stiffness and precurvature may be added, as in "
                    "force,stiffness",
                    printable(state)));
}

}  // namespace

void apply_options(const EstimateOptions& options, CatheterFile& file) {
  ObserverOptions& observer = file.observer;
  choose("--method", options.method, kMethods, observer.method);
  choose("--measurement", options.measurement, kMeasurements, observer.measurement);
  apply_state(options.state, observer);
  if (options.no_consider) observer.consider_uncertainty = false;
  choose("--force-model", options.force_model, kForceModels, observer.force_model);
  if (options.smooth && options.forecast_s > 0.0)
    throw InputError(
        fmt::format("--forecast {}: expected without --smooth, which knows what comes", options.forecast_s));
  if (!(options.forecast_s >= 0.0 && options.forecast_s <= 60.0))
    throw InputError(fmt::format("--forecast {}: expected seconds, 0 to 60", options.forecast_s));
  observer.forecast_s = options.forecast_s;
  if (!options.reference.empty()) {
    const TimeSpan span = parse_time_span("--reference", options.reference);
    file.reference.from_s = span.from_s;
    file.reference.to_s = span.to_s;
    file.reference.given = true;
  }
  observer.report_convergence_index = true;
}

void add_estimate_options(CLI::App& verb, EstimateOptions& options) {
  verb.add_option("recording", options.recordings,
                  "tracker CSV, PLUS .igs.mha, NDI CSV, marker CSV, or MR coil text (a file or its folder); several, "
                  "each with its own sensors, are merged by time")
      ->required();
  verb.add_option("--catheter", options.catheter, "catheter file (TOML)")->required();
  verb.add_option("--out", options.out, "estimate CSV to write")->required();
  verb.add_option("--tendon", options.tendon, "tendon CSV: moment or tension over time");
  verb.add_option("--method", options.method, "ekf, iekf, iaekf or ukf, instead of the catheter file's");
  verb.add_option("--measurement", options.measurement, "poses or tip_and_curvature, instead of the catheter file's");
  verb.add_option("--force-model", options.force_model,
                  "random_walk, constant_velocity, gauss_markov or rhythm, instead of the catheter file's");
  verb.add_option(
      "--state", options.state,
      "what is estimated: force, or force with stiffness (EI1, EI2), precurvature (k1,0, k2,0), or both, as in "
      "force,stiffness; instead of the catheter file's");
  verb.add_flag("--no-consider", options.no_consider,
                "the catheter file's sigmas are left out: the force's sigma is of noise alone");
  verb.add_option("--reference", options.reference,
                  "FROM:TO in seconds without tip force: corrects base and precurvature");
  verb.add_option("--average", options.average,
                  "FROM:TO in seconds of a load at rest: adds its mean force to the summary");
  verb.add_option("--budget", options.budget,
                  "CSV to write: what the sigma of each frame is made of, and what it cannot tell");
  verb.add_option("--plot", options.plot, "draw force and 95 % band over time (.svg or .png)");
  verb.add_flag("--smooth", options.smooth,
                "use later frames as well: the force of each frame in the light of the whole recording");
  verb.add_option("--forecast", options.forecast_s,
                  "SECONDS: adds columns with the force this far ahead, and its sigma");
  verb.add_flag("--strict", options.strict, "make every reading that would be passed over an error");
  verb.add_flag("--json", options.json, "print the summary as JSON");
  verb.footer(
      "Example: palpate estimate --catheter catheter.toml run.tracker.csv --out run.estimate.csv --plot run.svg\n"
      "         palpate estimate --catheter catheter.toml run.tracker.csv --tendon run.tendon.csv "
      "--state force,stiffness --out run.estimate.csv\n"
      "         palpate estimate --catheter catheter.toml run.tracker.csv --out run.estimate.csv --budget "
      "run.budget.csv\n"
      "         palpate estimate --catheter catheter.toml run.tracker.csv --out noise_alone.csv --no-consider");
}

}  // namespace palpate::app
