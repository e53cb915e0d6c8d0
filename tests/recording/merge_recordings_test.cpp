// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <palpate/observer/frame_clock.hpp>
#include <palpate/recording/merge_recordings.hpp>
#include <tests/random_draws.hpp>
#include <tests/recording/temporary_folder.hpp>

namespace palpate {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A recording of one sensor at these times; frame k has the number `first` + k and lies k mm along x.
TrackerRecording recording_of(const std::string& source, const std::string& sensor, const std::vector<double>& times_s,
                              std::int64_t first = 0) {
  TrackerRecording recording;
  recording.source = source;
  recording.sensor_names = {sensor};
  recording.sensor_lines = {2};
  for (const double time_s : times_s) {
    TrackerFrame& frame = recording.frames.emplace_back();
    frame.time_s = time_s;
    const auto k = static_cast<std::int64_t>(recording.frames.size()) - 1;
    frame.number = first + k;
    SensorReading& reading = frame.readings.emplace_back();
    reading.status = SensorReading::Status::kOk;
    reading.position_m.x() = 1e-3 * static_cast<double>(k);
  }
  return recording;
}

/// A word a frame: the sensors that are not absent, and its number: "a0 ab1".
std::string story(const TrackerRecording& recording) {
  std::string text;
  for (const TrackerFrame& frame : recording.frames) {
    text += text.empty() ? "" : " ";
    for (std::size_t i = 0; i < frame.readings.size(); ++i)
      if (frame.readings[i].status != SensorReading::Status::kAbsent) text += recording.sensor_names[i];
    text += std::to_string(frame.number);
  }
  return text;
}

class MergeRecordings : public test::TemporaryFolder {
 protected:
  std::string error(std::vector<TrackerRecording> recordings) const {
    return error_of([&] { merge_recordings(std::move(recordings)); });
  }
};

TEST_F(MergeRecordings, GoByTimeAndFramesOfEqualTimeBecomeOne) {
  const auto merged =
      merge_recordings({recording_of("A", "a", {0.0, 0.1, 0.2, 0.3}), recording_of("B", "b", {0.05, 0.2, 0.35}, 70)});
  EXPECT_EQ(story(merged), "a0 b70 a1 ab2 a3 b72");
  EXPECT_EQ(merged.source, "A, B");
  EXPECT_EQ(merged.sensor_names, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(merged.sensor_sources, (std::vector<std::string>{"A", "B"}));
  for (const TrackerFrame& frame : merged.frames) ASSERT_EQ(frame.readings.size(), 2u);
  EXPECT_EQ(merged.frames[3].time_s, 0.2);
  EXPECT_EQ(merged.frames[3].readings[0].position_m.x(), 2e-3);
  EXPECT_EQ(merged.frames[3].readings[1].position_m.x(), 1e-3);
  EXPECT_EQ(source_of(merged, merged.frames[1]), "B");
  EXPECT_EQ(source_of(merged, merged.frames[3]), "A");
}

TEST_F(MergeRecordings, OneAloneIsHandedBackAsItIs) {
  const std::vector<double> times_s = {0.3, kNaN, 0.1, 0.1, -5.0, 0.2, 0.25, 0.26, 0.27, 0.28, 0.29};
  std::vector<TrackerRecording> one = {recording_of("A", "a", times_s)};
  const auto merged = merge_recordings(one);
  EXPECT_EQ(merged.source, "A");
  EXPECT_TRUE(merged.sensor_sources.empty());
  ASSERT_EQ(merged.frames.size(), times_s.size());
  for (std::size_t i = 0; i < times_s.size(); ++i)
    EXPECT_TRUE(merged.frames[i].time_s == times_s[i] || (std::isnan(times_s[i]) && i == 1));
  EXPECT_EQ(source_of(merged, merged.frames[0]), "A");
}

/// A frame of an impossible time stays behind the one before it, and the frames of the others lie as without it.
TEST_F(MergeRecordings, ImpossibleTimesStayWhereTheyAreAndMoveNoOther) {
  const auto b = recording_of("B", "b", {0.05, 0.15, 0.25, 0.35});
  EXPECT_EQ(story(merge_recordings({recording_of("A", "a", {kNaN, 0.1, kNaN, 0.02, 0.2, 0.3}), b})),
            "a0 b0 a1 a2 a3 b1 a4 b2 a5 b3");
  EXPECT_EQ(story(merge_recordings({recording_of("A", "a", {0.1, 0.2, -HUGE_VAL, 0.2, 0.3}), b})),
            "b0 a0 b1 a1 a2 a3 b2 a4 b3");
  // 0.15 stands still in A: the joined frame is that of A's first, not of the one that is refused.
  EXPECT_EQ(story(merge_recordings({recording_of("A", "a", {0.15, 0.15, 0.2}), b})), "b0 ab0 a1 a2 b2 b3");
}

/// The observer's clock says of each merged frame what its source's own clock says of it. Times of every kind, seeded.
TEST_F(MergeRecordings, ClocksAgreeOnWhatIsImpossible) {
  test::Draws draws(7);
  const auto faulty = [&](const std::string& name, double period_s) {
    std::vector<double> times_s;
    for (int k = 0; k < 300; ++k) {
      const double u = draws.uniform(0.0, 1.0), now_s = period_s * k;
      times_s.push_back(u < 0.06 ? kNaN : u < 0.12 ? now_s - 1.0 : u < 0.18 && k > 0 ? times_s.back() : now_s);
    }
    return recording_of(name, name, times_s);
  };
  for (int trial = 0; trial < 20; ++trial) {
    const std::vector<TrackerRecording> sources = {faulty("a", 0.025), faulty("b", 0.08), faulty("c", 0.05)};
    const auto merged = merge_recordings(sources);
    FrameClock clock;
    std::vector<FrameClock> own(3);
    std::vector<std::int64_t> next(3, 0);
    double last_s = -1e9;
    for (const TrackerFrame& frame : merged.frames) {
      const bool accepted = clock.advance(frame.time_s).accepted();
      for (std::size_t i = 0; i < 3; ++i) {
        if (frame.readings[i].status == SensorReading::Status::kAbsent) continue;
        const TrackerFrame& origin = sources[i].frames[static_cast<std::size_t>(next[i]++)];
        EXPECT_EQ(frame.readings[i].position_m, origin.readings[0].position_m) << "a source's order is kept";
        EXPECT_EQ(own[i].advance(origin.time_s).accepted(), accepted);
      }
      if (!accepted) continue;
      EXPECT_GT(frame.time_s, last_s);
      last_s = frame.time_s;
    }
    EXPECT_EQ(next, (std::vector<std::int64_t>{300, 300, 300}));
  }
}

TEST_F(MergeRecordings, AClockThatIsSetBackIsRefused) {
  const auto b = recording_of("B", "b", {0.05, 0.15});
  const std::vector<double> times_s = {5.0, 5.1, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
  EXPECT_EQ(error({b, recording_of("A", "a", times_s, 40)}),
            "A: frame 47: field time_s: value '0.6': expected times that run on after 5.1 s, for recordings are merged "
            "by time; was the clock set back?");
}

TEST_F(MergeRecordings, ASensorInTwoIsRefusedUnlessIgnored) {
  const auto a = recording_of("A", "tip", {0.0, 0.1}), b = recording_of("B", "tip", {0.0, 0.2});
  EXPECT_EQ(error({a, b}), "B:2: field sensor: value 'tip': expected each sensor in one recording; A has it too");
  const auto merged = merge_recordings({a, b}, {"tip"});
  EXPECT_EQ(merged.sensor_names, std::vector<std::string>{"tip"});
  EXPECT_EQ(merged.frames.size(), 3u);
  EXPECT_EQ(merged.frames[0].readings[0].position_m.x(), 0.0);
}

TEST_F(MergeRecordings, NotesAndDuplicatesAreThoseOfAll) {
  auto a = recording_of("A", "a", {0.0}), b = recording_of("B", "b", {0.0}), c = recording_of("C", "c", {0.0});
  a.notes = {"one"};
  c.notes = {"two"};
  b.duplicate_rows = 2;
  b.first_duplicate = "frame 0";
  c.duplicate_rows = 3;
  c.first_duplicate = "frame 9";
  const auto merged = merge_recordings({a, b, c});
  EXPECT_EQ(merged.notes, (std::vector<std::string>{"one", "two"}));
  EXPECT_EQ(merged.duplicate_rows, 5u);
  EXPECT_EQ(merged.first_duplicate, "frame 0");
  EXPECT_EQ(merged.first_duplicate_source, "B");
}

TEST_F(MergeRecordings, BindingKeepsWhereEachSensorStands) {
  Catheter catheter;
  for (const char* name : {"b", "a"}) catheter.sensors.emplace_back().name = name;
  auto merged = merge_recordings({recording_of("A", "a", {0.0, 0.1}), recording_of("B", "b", {0.1})});
  bind_to_catheter(merged, catheter);
  EXPECT_EQ(merged.sensor_sources, (std::vector<std::string>{"B", "A"}));
  EXPECT_EQ(source_of(merged, merged.frames[0]), "A");
  EXPECT_EQ(story(merged), "a0 ba1");
  auto stranger = merge_recordings({recording_of("A", "a", {0.0}), recording_of("B", "stylus", {0.1})});
  EXPECT_EQ(error_of([&] { bind_to_catheter(stranger, catheter); }),
            "B:2: field sensor: value 'stylus': expected a sensor of the catheter (b, a), or [recording] "
            "ignore_sensors of the catheter file to name it");
}

TEST_F(MergeRecordings, ADelayIsTakenOffTheTimesOfARecording) {
  Catheter catheter;
  catheter.sensors.emplace_back().name = "a";
  catheter.sensors.emplace_back().name = "b";
  catheter.sensors[0].delay_s = 0.25;
  auto recording = recording_of("A", "a", {1.0, kNaN, 1.5});
  recording.sensor_names.push_back("stranger");
  correct_delay(recording, catheter);
  EXPECT_EQ(recording.frames[0].time_s, 0.75);
  EXPECT_TRUE(std::isnan(recording.frames[1].time_s));
  EXPECT_EQ(recording.frames[2].time_s, 1.25);

  auto other = recording_of("B", "b", {0.1 + 0.2});
  correct_delay(other, catheter);
  EXPECT_EQ(other.frames[0].time_s, 0.1 + 0.2);
  recording.sensor_names = {"a", "b"};
  const std::string message = error_of([&] { correct_delay(recording, catheter); });
  EXPECT_EQ(message,
            "A: sensor \"b\": delay_s = 0 in the catheter file: expected 0.25, that of sensor \"a\", for the two share "
            "the frames of this recording");
  catheter.base.tracked = true;
  catheter.base.sensor.name = "clamp";
  recording.sensor_names = {"clamp", "a"};
  EXPECT_NE(error_of([&] { correct_delay(recording, catheter); }), "no error");
}

}  // namespace
}  // namespace palpate
