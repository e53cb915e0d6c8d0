// SPDX-License-Identifier: Apache-2.0
#include "estimate_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <palpate/math/errors.hpp>
#include <palpate/recording/text_table.hpp>
#include <vector>

#include "file_paths.hpp"
#include "time_span.hpp"

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

/// All names, as the type of a value: completion proposes them.
template <class Names>
std::string words_of(const Names& known) {
  std::string words;
  for (const auto& named : known) words.append(words.empty() ? "" : "|").append(named.first);
  return words;
}

}  // namespace

std::string_view name_of(Method method) { return name_in(kMethods, method); }
std::string_view name_of(MeasurementKind kind) { return name_in(kMeasurements, kind); }
std::string_view name_of(ForceMotion motion) { return name_in(kForceModels, motion); }

void check_paths(const EstimateOptions& options) {
  std::vector<InputPath> inputs;
  for (const std::string& recording : options.recordings) inputs.push_back({"recording", "the recording", recording});
  inputs.push_back({"--catheter", "the catheter file", options.catheter});
  if (!options.tendon.empty()) inputs.push_back({"--tendon", "the tendon CSV", options.tendon});
  if (options.out.empty()) throw InputError("--out: expected the name of a file, found an empty one");
  check_paths(inputs, {{"--out", options.out}, {"--plot", options.plot}, {"--budget", options.budget}});
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
      ->type_name("FILE")
      ->required();
  verb.add_option("--catheter", options.catheter, "catheter file (TOML)")->type_name("FILE")->required();
  verb.add_option("--out", options.out, "estimate CSV to write")->type_name("FILE")->required();
  verb.add_option("--tendon", options.tendon,
                  "tendon CSV: moment or tension over time; with [tendon_map] where the handle stands")
      ->type_name("FILE");
  verb.add_option("--method", options.method, "the filter, instead of the catheter file's")
      ->type_name(words_of(kMethods));
  verb.add_option("--measurement", options.measurement, "what is compared with the rod, instead of the catheter file's")
      ->type_name(words_of(kMeasurements));
  verb.add_option("--force-model", options.force_model, "how the force moves, instead of the catheter file's")
      ->type_name(words_of(kForceModels));
  verb.add_option(
          "--state", options.state,
          "what is estimated: force, or force with stiffness (EI1, EI2), precurvature (k1,0, k2,0), or both, as in "
          "force,stiffness; instead of the catheter file's")
      ->type_name("LIST");
  verb.add_flag("--no-consider", options.no_consider,
                "the catheter file's sigmas are left out: the force's sigma is of noise alone");
  verb.add_option("--reference", options.reference, "seconds without tip force: corrects base and precurvature")
      ->type_name("FROM:TO");
  verb.add_option("--average", options.average, "seconds of a load at rest: adds its mean force to the summary")
      ->type_name("FROM:TO");
  verb.add_option("--budget", options.budget,
                  "CSV to write: what the sigma of each frame is made of, and what it cannot tell")
      ->type_name("FILE");
  verb.add_option("--plot", options.plot, "draw force and 95 % band over time (.svg or .png)")->type_name("FILE");
  verb.add_flag("--smooth", options.smooth,
                "use later frames as well: the force of each frame in the light of the whole recording");
  verb.add_option("--forecast", options.forecast_s, "adds columns with the force this far ahead, and its sigma")
      ->type_name("SECONDS");
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
