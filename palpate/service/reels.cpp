// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/math/errors.hpp>
#include <palpate/recording/scenario_file.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <palpate/service/demo.hpp>
#include <palpate/service/reels.hpp>
#include <palpate/session/reader.hpp>
#include <palpate/simulation/virtual_run.hpp>

namespace palpate::service {

namespace {

/// The frames of the catheter of this name; of the only one where there is but one.
TrackerRecording read_session(const CatheterSettings& catheter) {
  session::SessionReader reader(catheter.source.path);
  const auto& recorded = reader.catheters();
  std::size_t index = 0;
  while (recorded.size() > 1 && index < recorded.size() && recorded[index].name != catheter.name) ++index;
  if (index >= recorded.size())
    throw InputError(
        fmt::format("{}: expected a catheter \"{}\" in the session", catheter.source.path.string(), catheter.name));
  TrackerRecording out;
  out.source = catheter.source.path.string();
  out.sensor_names = recorded[index].sensor_names;
  out.sensor_lines.assign(out.sensor_names.size(), 0);
  session::LiveRecord record;
  while (reader.next(record))
    if (record.kind == session::LiveRecord::Kind::kFrame && record.catheter == static_cast<int>(index))
      out.frames.push_back(record.frame);
  return out;
}

std::vector<TrackerFrame> read_frames(const CatheterSettings& catheter) {
  const CatheterFile& file = catheter.settings;
  TrackerRecording recording = session::looks_like_session(catheter.source.path)
                                   ? read_session(catheter)
                                   : read_tracker_recording(catheter.source.path, {.catheter = &file.catheter});
  bind_to_catheter(recording, file.catheter, file.ignore_sensors);
  if (recording.frames.empty()) throw InputError(fmt::format("{}: expected at least one frame", recording.source));
  attach_known_loads(file.known_loads, recording.frames);
  return std::move(recording.frames);
}

/// Sensors of the scenario's catheter must be those of the catheter that watches.
void play_scenario(const CatheterSettings& catheter, Reel& reel) {
  const ScenarioFile scenario = read_scenario_file(catheter.source.path);
  TrackerRecording recording;
  recording.source = catheter.source.path.string();
  for (const Sensor& sensor : scenario.scenario.catheter.sensors) recording.sensor_names.push_back(sensor.name);
  const BaseRegistration& base = scenario.scenario.catheter.base;
  if (base.tracked) recording.sensor_names.push_back(base.sensor.name);
  recording.sensor_lines.assign(recording.sensor_names.size(), 0);
  VirtualRun run = run_scenario(scenario.scenario);
  reel.truth = truth_of(scenario.scenario, run);
  recording.frames = std::move(run.frames);
  bind_to_catheter(recording, catheter.settings.catheter, catheter.settings.ignore_sensors);
  reel.frames = std::move(recording.frames);
}

void play_demo(const CatheterSettings& catheter, Reel& reel) {
  const Scenario scenario = demo_scenario(catheter.settings.catheter);
  VirtualRun run = run_scenario(scenario);
  reel.truth = truth_of(scenario, run);
  reel.frames = std::move(run.frames);
}

}  // namespace

Reel make_reel(int index, const CatheterSettings& catheter, CatheterCounters& counters) {
  Reel reel{.catheter = index, .speed = catheter.source.speed, .loop = catheter.source.loop, .counters = &counters};
  switch (catheter.source.kind) {
    case SourceSettings::Kind::kDemo:
      play_demo(catheter, reel);
      break;
    case SourceSettings::Kind::kSimulation:
      play_scenario(catheter, reel);
      break;
    default:
      reel.frames = read_frames(catheter);
  }
  return reel;
}

}  // namespace palpate::service
