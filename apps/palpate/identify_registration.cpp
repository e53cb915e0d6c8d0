// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/tracker_recording.hpp>

#include "file_paths.hpp"
#include "identify_registration_report.hpp"
#include "time_span.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

struct Options {
  std::vector<std::string> recordings, intervals;
  std::string catheter, out, plot;
  double mount_sigma_mm = RegistrationOptions{}.mount_sigma_m * kMillimetresPerMetre;
  double mount_sigma_deg = RegistrationOptions{}.mount_sigma_rad / kRadiansPerDegree;
  bool mounting = false, json = false;
};

/// A part of one recording: the shaft at rest at one knob position.
struct Stretch {
  std::size_t recording = 0;
  TimeSpan span{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  std::string name = {};
};

void refuse_overlap(const Options& options, const std::vector<Stretch>& others, const Stretch& stretch) {
  for (const Stretch& other : others) {
    const bool same = options.recordings[other.recording] == options.recordings[stretch.recording];
    if (!same || stretch.span.from_s > other.span.to_s || other.span.from_s > stretch.span.to_s) continue;
    throw InputError(fmt::format("{}: overlaps {}: expected every frame once", stretch.name, other.name));
  }
}

/// Recordings as a whole, parts of one recording, or one part of each.
std::vector<Stretch> list_stretches(const Options& options) {
  const std::size_t recordings = options.recordings.size(), intervals = options.intervals.size();
  if (intervals > 0 && recordings > 1 && intervals != recordings)
    throw InputError(
        fmt::format("--interval: {} of them for {} recordings: expected none, one a recording in their order, or a "
                    "single recording",
                    intervals, recordings));
  std::vector<Stretch> stretches;
  for (std::size_t k = 0; k < std::max(recordings, intervals); ++k) {
    Stretch stretch{.recording = recordings > 1 ? k : 0};
    stretch.name = options.recordings[stretch.recording];
    if (intervals > 0) {
      stretch.span = parse_time_span("--interval", options.intervals[k]);
      stretch.name += fmt::format(" {}:{} s", stretch.span.from_s, stretch.span.to_s);
    }
    refuse_overlap(options, stretches, stretch);
    stretches.push_back(std::move(stretch));
  }
  return stretches;
}

/// The axes of a triad of markers are those of the stated base: they cannot tell where it is.
void refuse_triads(const Catheter& catheter, const std::string& file) {
  for (const Sensor& sensor : catheter.sensors)
    if (sensor.kind == SensorKind::kPose && !sensor.markers.empty())
      throw InputError(fmt::format(
          "{}: sensor \"{}\": markers of a pose take their axes from [base], which is to be found: expected "
          "kind \"position\", or a sensor with axes of its own",
          file, sensor.name));
}

TrackerRecording read_recording(const std::string& path, const CatheterFile& file, std::vector<std::string>& warnings) {
  TrackerRecording recording = read_tracker_recording(path, {.catheter = &file.catheter,
                                                             .reference_from_s = file.reference.from_s,
                                                             .reference_to_s = file.reference.to_s,
                                                             .reference_straight = file.reference.straight});
  for (const std::string& note : recording.notes) warnings.push_back(fmt::format("{}: {}", path, note));
  bind_to_catheter(recording, file.catheter, file.ignore_sensors);
  if (recording.frames.empty()) throw InputError(fmt::format("{}: expected at least one frame", path));
  return recording;
}

void require_frames(const TrackerRecording& recording, const Stretch& stretch) {
  const auto inside = [&](const TrackerFrame& frame) {
    return frame.time_s >= stretch.span.from_s && frame.time_s <= stretch.span.to_s;
  };
  if (std::any_of(recording.frames.begin(), recording.frames.end(), inside)) return;
  throw InputError(fmt::format(
      "{}: --interval {}:{}: expected an interval with frames; the recording goes from {} s to {} s", recording.source,
      stretch.span.from_s, stretch.span.to_s, recording.frames.front().time_s, recording.frames.back().time_s));
}

void warn_of_motion(const Catheter& catheter, const TrackerRecording& recording, const Stretch& stretch,
                    std::vector<std::string>& warnings) {
  for (const SensorDrift& drift : find_drift(catheter, recording.frames, stretch.span.from_s, stretch.span.to_s))
    warnings.push_back(fmt::format(
        "{}: sensor \"{}\" moved by {:.2f} mm meanwhile: expected a shaft at rest; --interval chooses a part of a "
        "recording",
        stretch.name, catheter.sensors[static_cast<std::size_t>(drift.sensor)].name,
        drift.moved_m * kMillimetresPerMetre));
}

std::vector<KnobPosition> read_positions(const Options& options, CatheterFile& file) {
  const std::vector<Stretch> stretches = list_stretches(options);
  std::vector<TrackerRecording> recordings;
  for (const std::string& path : options.recordings) recordings.push_back(read_recording(path, file, file.warnings));
  std::vector<KnobPosition> positions;
  for (const Stretch& stretch : stretches) {
    const TrackerRecording& recording = recordings[stretch.recording];
    require_frames(recording, stretch);
    warn_of_motion(file.catheter, recording, stretch, file.warnings);
    positions.push_back(
        {stretch.name, mean_reference_poses(file.catheter, recording.frames, stretch.span.from_s, stretch.span.to_s)});
  }
  return positions;
}

int run(const Options& options) {
  std::vector<InputPath> inputs{{"--catheter", "the catheter file", options.catheter}};
  for (const std::string& recording : options.recordings) inputs.push_back({"recording", "the recording", recording});
  check_paths(inputs, {{"--out", options.out}, {"--plot", options.plot}});
  CatheterFile file = read_catheter_file(options.catheter);
  TomlEdit edit(options.catheter);
  refuse_triads(file.catheter, options.catheter);
  const std::vector<KnobPosition> positions = read_positions(options, file);
  const Registration found = identify_registration(file.catheter, positions,
                                                   {.mounting = options.mounting,
                                                    .mount_sigma_m = options.mount_sigma_mm * kMetresPerMillimetre,
                                                    .mount_sigma_rad = options.mount_sigma_deg * kRadiansPerDegree});
  put_registration(found, options.mounting, edit);
  write_catheter_file(edit, options.out, [&] {
    if (!options.plot.empty()) plot_registration(found, positions, options.plot);
  });
  file.warnings.insert(file.warnings.end(), found.warnings.begin(), found.warnings.end());
  print_warnings(file.warnings);
  (options.json ? print_registration_json : print_registration)(found, options.mounting, options.out);
  return 0;
}

}  // namespace

void add_identify_registration(CLI::App& identify, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = identify.add_subcommand(
      "registration", "Base pose and sensor mounting from the unloaded shaft at several knob positions");
  verb->add_option("recording", options->recordings,
                   "recordings of the unloaded shaft at rest, one a knob position; or a single one with --interval")
      ->type_name("FILE")
      ->required();
  verb->add_option("--catheter", options->catheter, "catheter file (TOML); its base may be anything")
      ->type_name("FILE")
      ->required();
  verb->add_option("--out", options->out, "catheter file to write: the same with the base found")
      ->type_name("FILE")
      ->required();
  verb->add_option("--interval", options->intervals, "seconds, the shaft at rest; repeat for each position")
      ->type_name("FROM:TO")
      ->allow_extra_args(false);
  verb->add_flag("--mounting", options->mounting, "the mounting of the sensors is unknown, too");
  verb->add_option(
          "--mount-sigma-mm", options->mount_sigma_mm,
          "with --mounting: how far a sensor may be from its stated place, where the file has no mount_sigma_mm")
      ->capture_default_str();
  verb->add_option("--mount-sigma-deg", options->mount_sigma_deg,
                   "with --mounting: how far a sensor may be turned against its stated mounting")
      ->capture_default_str();
  verb->add_option("--plot", options->plot, "draw fitted shafts and residuals (.svg or .png)")->type_name("FILE");
  verb->add_flag("--json", options->json, "print the summary as JSON");
  verb->footer(
      "Example: palpate identify registration --catheter catheter.toml knob1.csv knob2.csv knob3.csv --out "
      "registered.toml --plot registered.svg\n"
      "         palpate identify registration --catheter catheter.toml run.csv --interval 0:5 --interval 8:13 "
      "--interval 16:21 --mounting --out registered.toml");
  verb->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace palpate::app
