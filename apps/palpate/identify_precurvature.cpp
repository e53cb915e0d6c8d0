// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/catheter_tendon_map.hpp>
#include <palpate/recording/precurvature_csv.hpp>
#include <palpate/recording/toml_edit.hpp>

#include "estimate_input.hpp"
#include "estimate_options.hpp"
#include "file_paths.hpp"
#include "handle_stretches.hpp"
#include "precurvature_report.hpp"
#include "time_span.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

struct Options {
  std::string data, catheter, out, map, tendon, input, interval, plot;
  double sigma_mm = 0.0, rest_s = 1.0;
  bool free_clamp = false, stated_clamp = false, json = false;
};

void check(const Options& options) {
  if (options.data.empty() == options.map.empty())
    throw InputError(
        options.data.empty()
            ? "expected points of the shaft, a recording, or --map with a table of the handle"
            : fmt::format("--map {}: expected without {}, for the table has it all", options.map, options.data));
  if (!options.map.empty() && !options.tendon.empty())
    throw InputError(fmt::format("--tendon {}: expected with a recording, not with --map", options.tendon));
  if (!options.interval.empty() && !(options.map.empty() && options.tendon.empty()))
    throw InputError(fmt::format("--interval {}: expected without --map and --tendon", options.interval));
  if (options.sigma_mm > 0.0 && !(options.map.empty() && options.tendon.empty()))
    throw InputError(fmt::format("--sigma-mm {}: expected without --map and --tendon", options.sigma_mm));
  if (!options.map.empty() && (options.free_clamp || options.stated_clamp))
    throw InputError(fmt::format("--map {}: expected without --free-clamp and --stated-clamp", options.map));
  if (!options.input.empty() && !tendon_input(options.input))
    throw InputError(fmt::format("--input {}: expected one of knob_rad, displacement_mm, tension_N", options.input));
  if (!(options.sigma_mm >= 0.0 && options.sigma_mm <= 100.0))
    throw InputError(fmt::format("--sigma-mm {}: expected mm, 0 (told by the residuals) to 100", options.sigma_mm));
  if (!(options.rest_s > 0.0 && options.rest_s <= 1e4))
    throw InputError(fmt::format("--rest {}: expected seconds, more than 0, at most 10000", options.rest_s));
  std::vector<InputPath> inputs{{"--catheter", "the catheter file", options.catheter}};
  inputs.push_back(options.map.empty() ? InputPath{"data", "the data", options.data}
                                       : InputPath{"--map", "the table", options.map});
  if (!options.tendon.empty()) inputs.push_back({"--tendon", "the tendon CSV", options.tendon});
  check_paths(inputs, {{"--out", options.out}, {"--plot", options.plot}});
}

ClampKnowledge clamp_of(const Options& options, ClampKnowledge otherwise) {
  if (options.free_clamp) return ClampKnowledge::kFree;
  return options.stated_clamp ? ClampKnowledge::kStated : otherwise;
}

/// A message about data says of which file.
template <class Work>
auto naming(const std::string& file, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    const std::string message = error.what();
    throw InputError(message.starts_with(file) ? message : fmt::format("{}: {}", file, message));
  }
}

/// The unloaded shaft: what bends it besides its own shape is what is looked for. The error of a tracked base's sensor
/// is that of the clamp.
CatheterFile unloaded(const CatheterFile& file) {
  CatheterFile out = file;
  out.catheter.tendon.present = out.catheter.tendon_map.present = false;
  out.known_loads.clear();
  BaseRegistration& base = out.catheter.base;
  if (!base.tracked) return out;
  base.position_sigma_m =
      std::hypot(base.position_sigma_m, base.sensor.bias_m / std::sqrt(3.0), base.sensor.mount_sigma_m);
  base.rotation_sigma_rad = std::hypot(base.rotation_sigma_rad, base.sensor.bias_rad / std::sqrt(3.0));
  return out;
}

TrackerRecording load(const Options& options, const CatheterFile& file, std::vector<std::string>& warnings) {
  EstimateOptions as_estimate;
  as_estimate.recordings = {options.data};
  return load_recording(as_estimate, file, warnings);
}

ArcData arc_data(const Options& options, const CatheterFile& file, std::vector<std::string>& warnings) {
  ArcData data;
  const Rod& rod = file.catheter.rod;
  if (is_shaft_point_csv(options.data)) {
    if (!options.interval.empty())
      throw InputError(fmt::format("--interval {}: expected with a recording, not with points", options.interval));
    const std::vector<ShaftPointRow> rows = read_shaft_point_csv(options.data, rod.length_m() + rod.rigid_tip_m);
    data.points.reserve(rows.size());
    for (const ShaftPointRow& row : rows) data.points.push_back({row.arc_length_m, row.position_m});
    data.point_sigma_m = options.sigma_mm * kMetresPerMillimetre;
    return data;
  }
  if (options.sigma_mm > 0.0)
    throw InputError(fmt::format("--sigma-mm {}: expected with points; sensors have noise_mm", options.sigma_mm));
  TimeSpan span{-HUGE_VAL, HUGE_VAL};
  if (!options.interval.empty()) span = parse_time_span("--interval", options.interval);
  const TrackerRecording recording = load(options, file, warnings);
  data.poses = mean_poses(file.catheter, recording.frames, span.from_s, span.to_s);
  if (std::none_of(data.poses.begin(), data.poses.end(), [](const MeanPose& pose) { return pose.count > 0; }))
    throw InputError(fmt::format("{}: --interval {}: expected usable frames in it", options.data,
                                 options.interval.empty() ? "(all)" : options.interval));
  return data;
}

/// Whoever is not told keeps the file's value and sigma.
void write_arc(const CatheterFile& file, const ArcFit& fit, const Options& options) {
  TomlEdit edit(options.catheter);
  std::vector<double> k, sigma;
  for (int i = 0; i < 3; ++i) {
    const bool told = fit.told[static_cast<std::size_t>(i)];
    k.push_back(told ? fit.precurvature_per_m(i) : file.catheter.precurvature_per_m()(i));
    sigma.push_back(told ? std::sqrt(fit.covariance(i, i)) : file.catheter.precurvature_sigma_per_m(i));
  }
  const std::string comment = fmt::format("identified: arc through {} places, rms {:.3f} mm", fit.places.size(),
                                          fit.rms_m * kMillimetresPerMetre);
  edit.set("catheter", "precurvature_sigma_per_m", toml_array(sigma, 4), "identified");
  edit.set("catheter", "precurvature_per_m", toml_array(k), comment);
  for (const Section& section : parse_catheter({.name = options.out, .lines = edit.lines()}).catheter.rod.sections)
    if (!section.rigid && (section.precurvature_per_m - Vector3d(k[0], k[1], k[2])).norm() > 1e-3)
      throw InputError(
          fmt::format("{}: catheter.section.precurvature_per_m: expected none of its own, for one arc is identified",
                      options.catheter));
  write_catheter_file(edit, options.out, [&] {
    if (!options.plot.empty()) plot_arc(file.catheter, fit, options.plot);
  });
}

void print(const std::vector<std::string>& warnings, const std::string& text, nlohmann::json json,
           const Options& options) {
  print_warnings(warnings);
  if (!options.json) return fmt::print("{}written: {}\n", text, options.out);
  json["written"] = options.out;
  json["warnings"] = warnings;
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

void identify_arc(const Options& options, const CatheterFile& file) {
  const CatheterFile shaft = unloaded(file);
  std::vector<std::string> warnings = file.warnings;
  const ArcData data = arc_data(options, shaft, warnings);
  const ClampKnowledge clamp =
      clamp_of(options, data.points.empty() ? ClampKnowledge::kStated : ClampKnowledge::kExact);
  const ArcFit fit = naming(options.data, [&] { return fit_arc(shaft.catheter, data, clamp); });
  write_arc(file, fit, options);
  warnings.insert(warnings.end(), fit.warnings.begin(), fit.warnings.end());
  print(warnings, "precurvature of the unloaded shaft\n" + in_words(fit), to_json(fit), options);
}

void write_map(const TendonMapFit& fit, const std::vector<HandleSample>& samples, const CatheterFile& file,
               const Options& options) {
  TomlEdit edit(options.catheter);
  const std::string comment =
      fmt::format("identified: {} positions pulled to, {} released to", fit.pulls, fit.releases);
  write_tendon_map(fit.map, comment, edit);
  write_catheter_file(edit, options.out, [&] {
    if (!options.plot.empty()) plot_map(fit, samples, file.catheter.name, options.plot);
  });
}

TendonInput input_of(const Options& options, const CatheterFile& file) {
  if (!options.input.empty()) return *tendon_input(options.input);
  return file.catheter.tendon_map.present ? file.catheter.tendon_map.input : TendonInput::kKnob;
}

void identify_map(const Options& options, const CatheterFile& file) {
  std::vector<std::string> warnings = file.warnings;
  std::vector<HandleSample> samples;
  std::string text;
  TendonMapFit fit;
  if (!options.map.empty()) {
    const HandleTable table =
        read_handle_table_csv(options.map, options.input.empty() ? std::nullopt : tendon_input(options.input),
                              file.catheter.precurvature_per_m().y());
    samples.reserve(table.rows.size());
    for (const HandleRow& row : table.rows)
      samples.push_back({row.position, row.release, row.precurvature_per_m, row.sigma_per_m});
    fit = naming(options.map, [&] { return fit_tendon_map(samples, table.input); });
    if (!table.has_k2) fit.map.sigma_per_m.y() = file.catheter.precurvature_sigma_per_m.y();
  } else {
    const CatheterFile shaft = unloaded(file);
    const TrackerRecording recording = load(options, shaft, warnings);
    const HandleTrace handle = read_handle_csv(options.tendon, input_of(options, file));
    const std::vector<HandleStretch> stretches = naming(options.data, [&] {
      return find_stretches(shaft.catheter, recording, handle, options.rest_s,
                            clamp_of(options, ClampKnowledge::kStated));
    });
    samples = samples_of(stretches);
    fit = naming(options.tendon, [&] { return fit_tendon_map(samples, input_of(options, file), true); });
    for (const HandleStretch& stretch : stretches)
      if (stretch.arc.doubtful)
        warnings.push_back(fmt::format("{}: at rest from {:.2f} to {:.2f} s: {}", options.data, stretch.from_s,
                                       stretch.to_s, stretch.arc.warnings.front()));
    text = fmt::format("{} stretches with the handle at rest\n", stretches.size());
  }
  write_map(fit, samples, file, options);
  warnings.insert(warnings.end(), fit.warnings.begin(), fit.warnings.end());
  print(warnings, text + in_words(fit), to_json(fit, samples), options);
}

int run(const Options& options) {
  check(options);
  const CatheterFile file = read_catheter_file(options.catheter);
  if (options.map.empty() && options.tendon.empty())
    identify_arc(options, file);
  else
    identify_map(options, file);
  return 0;
}

void add_options(CLI::App& verb, Options& options) {
  verb.add_option("data", options.data,
                  "points of the unloaded shaft (CSV: arc_length_mm and two or three of x_mm,y_mm,z_mm), or a "
                  "recording of its sensors")
      ->type_name("FILE");
  verb.add_option("--catheter", options.catheter, "catheter file (TOML)")->type_name("FILE")->required();
  verb.add_option("--out", options.out, "catheter file to write, with what was identified")
      ->type_name("FILE")
      ->required();
  verb.add_option("--interval", options.interval, "seconds of the recording, shaft unloaded; else all of it")
      ->type_name("FROM:TO");
  verb.add_option("--sigma-mm", options.sigma_mm,
                  "noise of the points, one standard deviation; else the residuals tell");
  auto* free = verb.add_flag("--free-clamp", options.free_clamp, "the clamp may stand anywhere: it is found as well");
  verb.add_flag("--stated-clamp", options.stated_clamp,
                "points: the clamp is off by what [base] states (always so with a recording)")
      ->excludes(free);
  verb.add_option("--map", options.map,
                  "identify a tendon map: CSV with knob_rad, displacement_mm or tension_N, k1_per_m, ...")
      ->type_name("FILE");
  verb.add_option("--tendon", options.tendon,
                  "identify a tendon map: tendon CSV beside the recording; one arc for each rest of the handle")
      ->type_name("FILE");
  verb.add_option("--input", options.input, "what the map goes by")->type_name("knob_rad|displacement_mm|tension_N");
  verb.add_option("--rest", options.rest_s, "that the handle stands still, at least")
      ->type_name("SECONDS")
      ->capture_default_str();
  verb.add_option("--plot", options.plot, "draw points against the fit, and what is left (.svg or .png)")
      ->type_name("FILE");
  verb.add_flag("--json", options.json, "print the summary as JSON");
  verb.footer(
      "Example: palpate identify precurvature --catheter c.toml points.csv --sigma-mm 0.28 --out bent.toml --plot "
      "p.svg\n"
      "         palpate identify precurvature --catheter c.toml rest.tracker.csv --interval 0:2 --out bent.toml\n"
      "         palpate identify precurvature --catheter c.toml --map handle.csv --out mapped.toml --plot map.svg\n"
      "         palpate identify precurvature --catheter c.toml run.tracker.csv --tendon run.tendon.csv --out "
      "mapped.toml");
}

}  // namespace

void add_identify_precurvature(CLI::App& identify, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      identify.add_subcommand("precurvature", "Curvature of the unloaded shaft, and how the handle changes it");
  add_options(*verb, *options);
  verb->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace palpate::app
