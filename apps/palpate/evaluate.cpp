// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <palpate/evaluation/evaluation.hpp>
#include <palpate/math/errors.hpp>

#include "verbs.hpp"

namespace palpate::app {

namespace {

struct Options {
  std::string estimate, truth, bounds, recording;
  bool json = false;
};

/// `rms_bound_tip_frame_N` of one recording in a bounds file.
Vector3d read_bound(const std::string& path, const std::string& recording) {
  std::ifstream stream(path);
  if (!stream) throw InputError(fmt::format("{}: cannot be read", path));
  const nlohmann::json bounds = nlohmann::json::parse(stream, nullptr, false);
  if (!bounds.is_object()) throw InputError(fmt::format("{}: expected a JSON object", path));
  const auto entry = bounds.find(recording);
  if (entry == bounds.end())
    throw InputError(fmt::format("{}: no entry \"{}\": expected the name of a recording in this file (--recording)",
                                 path, recording));
  const auto bound = entry->find("rms_bound_tip_frame_N");
  const auto is_number = [](const nlohmann::json& value) { return value.is_number(); };
  if (bound == entry->end() || !bound->is_array() || bound->size() != 3 ||
      !std::all_of(bound->begin(), bound->end(), is_number))
    throw InputError(fmt::format("{}: {}: expected \"rms_bound_tip_frame_N\" with three numbers", path, recording));
  return {bound->at(0).get<double>(), bound->at(1).get<double>(), bound->at(2).get<double>()};
}

nlohmann::json by_axis(const Vector3d& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

nlohmann::json to_json(const Evaluation& e, const std::optional<Vector3d>& bound) {
  nlohmann::json out{{"frames", e.frames},
                     {"frames_outside_truth", e.outside_truth},
                     {"frames_updated", e.updated},
                     {"mean_error_N", by_axis(e.mean_N)},
                     {"sigma_error_N", by_axis(e.sigma_N)},
                     {"rmse_N", by_axis(e.rmse_N)},
                     {"largest_error_N", by_axis(e.largest_N)},
                     {"share_inside_95_percent_interval", by_axis(e.inside_95)},
                     {"share_inside_3_sigma", by_axis(e.inside_3_sigma)},
                     {"mean_nees", e.mean_nees},
                     {"frames_without_valid_covariance", e.indefinite}};
  if (bound) {
    out["bound_N"] = by_axis(*bound);
    out["rmse_over_bound"] = by_axis(e.rmse_N.cwiseQuotient(*bound));
  }
  return out;
}

void print_row(const char* what, const Vector3d& v, const char* unit, double scale = 1.0) {
  fmt::print("  {:<24}{:>12.4f}{:>12.4f}{:>12.4f}  {}\n", what, scale * v.x(), scale * v.y(), scale * v.z(), unit);
}

void print_table(const Evaluation& e, const std::optional<Vector3d>& bound) {
  fmt::print("{} frames judged ({} updated, {} held); error = estimate - truth, tip components\n", e.frames, e.updated,
             e.frames - e.updated);
  if (e.outside_truth > 0)
    fmt::print("{} frames lie outside the truth's time span and were left out\n", e.outside_truth);
  fmt::print("  {:<24}{:>12}{:>12}{:>12}\n", "", "Fx (d1)", "Fy (d2)", "Fz (d3)");
  print_row("mean error", e.mean_N, "mN", 1e3);
  print_row("sigma of error", e.sigma_N, "mN", 1e3);
  print_row("RMSE", e.rmse_N, "mN", 1e3);
  print_row("largest error", e.largest_N, "mN", 1e3);
  print_row("truth inside 95 %", e.inside_95, "% of frames", 1e2);
  print_row("truth inside 3 sigma", e.inside_3_sigma, "% of frames", 1e2);
  if (bound) print_row("RMSE / bound", e.rmse_N.cwiseQuotient(*bound), "");
  fmt::print("  {:<24}{:>12.4f}  (3 where the covariance is true)\n", "mean NEES", e.mean_nees);
  if (e.indefinite > 0) fmt::print("{} frames have no valid covariance and are not in the NEES\n", e.indefinite);
}

int run(const Options& options) {
  const std::vector<EstimateRow> estimate = read_estimate_csv(options.estimate);
  const ForceTrace truth = read_force_csv(options.truth);
  std::optional<Vector3d> bound;
  if (!options.bounds.empty()) bound = read_bound(options.bounds, options.recording);
  const Evaluation evaluation = evaluate(estimate, truth);
  if (options.json)
    fmt::print("{}\n", to_json(evaluation, bound).dump(2));
  else
    print_table(evaluation, bound);
  return 0;
}

}  // namespace

void add_evaluate(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand("evaluate", "Hold an estimate against a force sensor's trace");
  verb->add_option("--estimate", options->estimate, "estimate CSV, from palpate estimate")
      ->type_name("FILE")
      ->required();
  verb->add_option("--truth", options->truth, "force CSV of a force sensor or a simulation")
      ->type_name("FILE")
      ->required();
  CLI::Option* bounds = verb->add_option("--bounds", options->bounds, "JSON with Cramer-Rao bounds: adds RMSE / bound")
                            ->type_name("FILE");
  CLI::Option* recording =
      verb->add_option("--recording", options->recording, "name of the recording in --bounds")->type_name("NAME");
  bounds->needs(recording);
  recording->needs(bounds);
  verb->add_flag("--json", options->json, "print the figures as JSON");
  verb->footer("Example: palpate evaluate --estimate run.estimate.csv --truth run.force.csv");
  verb->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace palpate::app
