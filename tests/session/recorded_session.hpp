// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <palpate/observer/force_observer.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <palpate/session/session_run_reader.hpp>
#include <palpate/session/writer.hpp>
#include <thread>

namespace palpate::test {

/// A recording played into a session as a live process would: one catheter, each frame with its estimate, an event
/// behind frame 100 that changed nothing.
inline void record_session(const std::filesystem::path& path, const std::string& name, const std::string& toml,
                           const std::filesystem::path& recording_path, const std::string& event = "note",
                           const std::string& data = R"({"text":"contact"})") {
  session::SessionCatheter catheter{name, name + ".toml", toml, {}};
  const CatheterFile settings = session::settings_of(catheter);
  TrackerRecording recording = read_tracker_recording(recording_path);
  bind_to_catheter(recording, settings.catheter, settings.ignore_sensors);
  for (const Sensor& sensor : settings.catheter.sensors) catheter.sensor_names.push_back(sensor.name);
  session::SessionWriter writer(path, {catheter}, {.batch_s = 0.01, .program_version = "test"});
  ForceObserver observer(settings.catheter, settings.observer);
  const auto offer = [&](const session::LiveRecord& record) {
    while (!writer.offer(record)) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  };
  session::LiveRecord record;
  for (const TrackerFrame& frame : recording.frames) {
    record.kind = session::LiveRecord::Kind::kFrame;
    record.received_ns += 25'000'000;
    record.output_time_s = 1e-9 * static_cast<double>(record.received_ns);
    record.frame = frame;
    record.estimate = observer.update(frame);
    offer(record);
    if (frame.number != 100) continue;
    record.kind = session::LiveRecord::Kind::kEvent;
    record.event = event;
    record.data = data;
    offer(record);
  }
  EXPECT_EQ(writer.close().committed, recording.frames.size() + 1);
}

}  // namespace palpate::test
