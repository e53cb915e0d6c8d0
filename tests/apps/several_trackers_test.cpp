// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/csv_writers.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <tests/apps/app_fixture.hpp>

namespace palpate {
namespace {

using test::RecordingText;
using Row = RecordingText::Row;

constexpr double kDuration_s = 8.0;
constexpr const char* kSecondFrame =
    "base_quaternion_wxyz = [0.5, -0.5, 0.5, 0.5]\nbase_position_mm = [900, 10, -60]\n";

/// The tip is seen at 40 Hz by one tracker, the shaft at 12 Hz by another with a frame of its own: a.csv and b.csv.
/// Every 0.25 s both speak at the same time.
class SeveralTrackers : public test::App {
 protected:
  void SetUp() override {
    test::App::SetUp();
    write_catheter("arc_length_mm = 65.3\n", std::string("arc_length_mm = 65.3\n") + kSecondFrame);
    a_ = seen_by(0, 40.0, 21);
    b_ = seen_by(1, 12.0, 22);
    write("a.csv", a_.text());
    write("b.csv", b_.text());
  }

  /// The one sensor's rows of a simulation of c.toml.
  RecordingText seen_by(std::size_t sensor, double rate_hz, std::uint64_t seed) const {
    const Catheter catheter = read_catheter_file(path("c.toml")).catheter;
    auto frames =
        simulate_tracker(catheter, beating_wall_force, {.rate_hz = rate_hz, .duration_s = kDuration_s, .seed = seed})
            .frames;
    for (TrackerFrame& frame : frames)
      for (std::size_t i = 0; i < frame.readings.size(); ++i)
        if (i != sensor) frame.readings[i].status = SensorReading::Status::kAbsent;
    write_tracker_csv(path("made.csv"), catheter, frames);
    auto text = RecordingText::parse(contents(path("made.csv")));
    std::filesystem::remove(path("made.csv"));
    return text;
  }

  static Arguments of(const Arguments& recordings, const Arguments& more = {}) {
    Arguments arguments{"estimate", "--catheter", "c.toml"};
    arguments.insert(arguments.end(), recordings.begin(), recordings.end());
    arguments.insert(arguments.end(), {"--out", "e.csv"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  nlohmann::json summary_of(const Arguments& recordings, const Arguments& more = {}) const {
    Arguments arguments = of(recordings, more);
    arguments.emplace_back("--json");
    const auto run = palpate(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out, nullptr, false);
  }
  /// The refusal, over an older e.csv and without; nothing is left behind either way.
  std::string refusal_of(const Arguments& recordings, const Arguments& more = {}) const {
    std::filesystem::remove(path("e.csv"));
    const std::string message = refusal(of(recordings, more));
    write("e.csv", "older");
    EXPECT_EQ(refusal(of(recordings, more)), message);
    return message;
  }

  /// All rows in one file, by time: rows of one time are a frame.
  static RecordingText together(const RecordingText& a, const RecordingText& b) {
    RecordingText all = a;
    all.rows.insert(all.rows.end(), b.rows.begin(), b.rows.end());
    std::stable_sort(all.rows.begin(), all.rows.end(), [](const Row& x, const Row& y) {
      return std::stod(x[RecordingText::kTime]) < std::stod(y[RecordingText::kTime]);
    });
    std::map<std::string, int> frames;
    for (Row& row : all.rows)
      row[RecordingText::kFrame] =
          std::to_string(frames.emplace(row[RecordingText::kTime], static_cast<int>(frames.size())).first->second);
    return all;
  }

  RecordingText a_, b_;
};

// 40 and 12 frames a second, 4 of them at the same times: 48 a second, with 52 of 96 readings.
TEST_F(SeveralTrackers, TheForceIsFollowedWithAnHonestSigma) {
  const auto said = summary_of({"a.csv", "b.csv"});
  EXPECT_EQ(said["recording"], "a.csv, b.csv");
  EXPECT_EQ(said["frames"], 48 * 8);
  EXPECT_EQ(said["frames_by_status"]["UPDATED"], 48 * 8);
  EXPECT_EQ(said["sensors_not_in_a_frame"], 44 * 8);
  for (const auto& [reason, count] : said["readings_not_used"].items()) EXPECT_EQ(count, 0) << reason;
  for (const auto& [reason, count] : said["rejected_rows"].items()) EXPECT_EQ(count, 0) << reason;
  const auto rows = table();
  ASSERT_EQ(rows.size(), 48u * 8u);
  std::size_t judged = 0, inside = 0, both = 0;
  double last_s = -1.0;
  for (const auto& row : rows) {
    const double time_s = test::number(row, "time_s");
    EXPECT_GT(time_s, last_s);
    last_s = time_s;
    both += row.at("sensors_used") == "2";
    if (time_s < 1.0) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string name(1, "xyz"[axis]);
      const double error_N = test::number(row, "f" + name + "_tip_N") - beating_wall_force(time_s)(axis);
      const double sigma_N = test::number(row, "sigma_" + name + "_N");
      EXPECT_LE(std::abs(error_N), 5.0 * sigma_N) << "at " << time_s << " s, axis " << name;
      ++judged;
      inside += std::abs(error_N) <= 1.959964 * sigma_N;
    }
  }
  EXPECT_EQ(both, 4u * 8u);
  EXPECT_GT(static_cast<double>(inside) / static_cast<double>(judged), 0.90);
  // Most frames have 6 rows. Three of them prove the noise (1 each); three compare with a prediction that allows for
  // more motion than there is (0.2 N/sqrt(s) against a slow wall), and count for less.
  EXPECT_GT(said["nis_per_dof"], 0.45);
  EXPECT_LT(said["nis_per_dof"], 1.0);
}

// One file that holds the same rows gives the same bytes; the order of the recordings does not matter.
TEST_F(SeveralTrackers, AreAsOneFileWithTheSameRows) {
  summary_of({"a.csv", "b.csv"});
  const std::string merged = contents(path("e.csv"));
  write("one.csv", together(a_, b_).text());
  EXPECT_EQ(summary_of({"one.csv"})["sensors_not_in_a_frame"], 44 * 8);
  EXPECT_TRUE(contents(path("e.csv")) == merged);
  summary_of({"b.csv", "a.csv"});
  EXPECT_TRUE(contents(path("e.csv")) == merged);
}

// Without the second tracker's own registration its poses lie elsewhere.
TEST_F(SeveralTrackers, ASensorFarFromItsOwnBaseIsRefused) {
  const std::string moved = "arc_length_mm = 65.3\nbase_quaternion_wxyz = [0.5, -0.5, 0.5, 0.5]\n";
  write_catheter("arc_length_mm = 65.3\n", moved + "base_position_mm = [0, 10, -60]\n");
  std::string message = refusal_of({"a.csv", "b.csv"});
  EXPECT_TRUE(message.starts_with("b.csv: sensor \"shaft\": never nearer than ")) << message;
  EXPECT_TRUE(message.ends_with("expected at most 125 mm; is its base_position_mm that of this setup?")) << message;
  const std::string fixed = "quaternion_wxyz = [0.7071067811865476, 0.0, 0.7071067811865476, 0.0]\nposition_mm = ";
  std::string tracked = contents(path("c.toml"));
  tracked.replace(tracked.find(fixed), fixed.size() + 22, "sensor = \"clamp\"");
  write("c.toml", tracked);  // which says nothing of the shaft's own base
  for (Row& row : a_.rows) row[RecordingText::kSensor] = "clamp";
  write("clamp.csv", a_.text());
  EXPECT_EQ(refusal_of({"a.csv", "b.csv", "clamp.csv"}), message);
  write_catheter("[base]", "[base]");  // no registration of its own
  message = refusal_of({"a.csv", "b.csv"});
  EXPECT_TRUE(message.starts_with("b.csv: sensor \"shaft\": never nearer than ")) << message;
  EXPECT_TRUE(message.ends_with("is [base] that of this setup?")) << message;
}

TEST_F(SeveralTrackers, AbsentIsCountedApartFromMissing) {
  for (const int frame : {10, 11, 50}) RecordingText::set_missing(b_.at(frame, "shaft"));
  RecordingText::set_missing(a_.at(102, "tip"));
  RecordingText::set_missing(a_.at(101, "tip"));
  write("a.csv", a_.text());
  write("b.csv", b_.text());
  const auto said = summary_of({"a.csv", "b.csv"}, {"--strict"});
  EXPECT_EQ(said["sensors_not_in_a_frame"], 44 * 8);
  EXPECT_EQ(said["readings_not_used"]["missing"], 5);
  EXPECT_EQ(said["frames_by_status"]["HELD"], 5);  // none of them at a time at which both speak
  EXPECT_EQ(table().size(), 48u * 8u);
}

// Frames of one tracker with impossible times are refused; all the others are as if those had never been.
TEST_F(SeveralTrackers, ImpossibleTimesOfOneDisturbNothing) {
  RecordingText without = b_, spoilt = b_;
  const std::map<std::string, const char*> wrong = {{"13", "nan"}, {"20", "0.3"}, {"40", "-inf"}, {"41", "3.250000"}};
  std::erase_if(without.rows, [&](const Row& row) { return wrong.contains(row[RecordingText::kFrame]); });
  for (const auto& [frame, time] : wrong) spoilt.at(std::stoi(frame), "shaft")[RecordingText::kTime] = time;
  write("b.csv", without.text());
  summary_of({"a.csv", "b.csv"});
  const std::string expected = contents(path("e.csv"));
  write("b.csv", spoilt.text());
  const auto said = summary_of({"a.csv", "b.csv"});
  EXPECT_EQ(said["frames_by_status"]["REJECTED"], 4);
  EXPECT_EQ(said["rejected_rows"]["time_not_finite"], 2);
  EXPECT_EQ(said["rejected_rows"]["time_steps_back"], 1);
  EXPECT_EQ(said["rejected_rows"]["time_stands_still"], 1);
  std::istringstream lines(contents(path("e.csv")));
  std::string kept;
  for (std::string line; std::getline(lines, line);)
    if (line.find("REJECTED") == std::string::npos) kept += line + "\n";
  EXPECT_TRUE(kept == expected);
  EXPECT_EQ(refusal_of({"a.csv", "b.csv"}, {"--strict"}),
            "b.csv: frame 13 at nan s: time is not finite: expected seconds (--strict)");
}

TEST_F(SeveralTrackers, ADelayIsTakenOff) {
  summary_of({"a.csv", "b.csv"});
  const auto expected = table();
  for (Row& row : b_.rows) row[RecordingText::kTime] = std::to_string(std::stod(row[RecordingText::kTime]) + 0.5);
  write("b.csv", b_.text());
  write("c.toml", contents(path("c.toml")) + "delay_s = 0.5\n");  // of the last sensor, the shaft
  summary_of({"a.csv", "b.csv"});
  const auto rows = table();
  ASSERT_EQ(rows.size(), expected.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const char* column : {"time_s", "fx_tip_N", "fy_tip_N", "fz_tip_N", "sigma_x_N", "sigma_z_N"})
      EXPECT_NEAR(test::number(rows[i], column), test::number(expected[i], column), 2e-8) << i << column;
  write("one.csv", together(a_, b_).text());
  EXPECT_EQ(
      refusal_of({"one.csv"}),
      "one.csv: sensor \"shaft\": delay_s = 0.5 in the catheter file: expected 0, that of sensor \"tip\", for the "
      "two share the frames of this recording");
}

// A tracked base at 12 Hz and a tip at 40 Hz meet in 4 frames a second. The base of an earlier frame is not used again.
TEST_F(SeveralTrackers, AFrameWithoutItsTrackedBaseIsHeld) {
  const std::string fixed = "quaternion_wxyz = [0.7071067811865476, 0.0, 0.7071067811865476, 0.0]\n";
  write_catheter(fixed + "position_mm = [20.0, -40.0, -180.0]", "sensor = \"clamp\"");
  std::string text = contents(path("c.toml"));
  text.resize(text.rfind("[[sensor]]"));
  write("c.toml", text);  // the tip alone, on a tracked base that stands at the tracker's origin
  write("tip.csv", seen_by(0, 40.0, 31).text());
  write("clamp.csv", seen_by(1, 12.0, 32).text());
  const auto run = palpate(of({"tip.csv", "clamp.csv"}, {"--strict", "--json"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err,
            "palpate: warning: tip.csv, clamp.csv: only 32 of 384 frames could be used: is it of this catheter, base "
            "and sensors?\n");
  const auto said = nlohmann::json::parse(run.out, nullptr, false);
  EXPECT_EQ(said["frames_by_status"]["UPDATED"], 4 * 8);
  EXPECT_EQ(said["frames_by_status"]["HELD"], 44 * 8);
  EXPECT_EQ(said["readings_not_used"]["missing"], 0);
  for (const auto& row : table()) {
    const double quarters = 4.0 * test::number(row, "time_s");
    EXPECT_EQ(row.at("status"), std::abs(quarters - std::round(quarters)) < 1e-9 ? "UPDATED" : "HELD");
  }
}

TEST_F(SeveralTrackers, WhatIsWrongIsNamedWithItsFile) {
  EXPECT_EQ(refusal_of({"a.csv", "a.csv"}),
            "a.csv:2: field sensor: value 'tip': expected each sensor in one recording; a.csv has it too");
  EXPECT_EQ(refusal_of({"a.csv", "no.csv"}),
            "no.csv: cannot be opened: No such file or directory: expected a readable text file");
  EXPECT_EQ(refusal_of({"a.csv", ""}), "recording: expected the name of a file, found an empty one");
  EXPECT_EQ(refusal(of({"a.csv", "b.csv"}, {"--plot", "./b.csv"})),
            "--plot ./b.csv: expected another file than the recording");
  EXPECT_EQ(refusal_of({"a.csv"}),
            "a.csv: field sensor: value 'shaft': expected this sensor of the catheter to occur; the recording has tip");

  RecordingText other = b_;
  other.at(7, "shaft")[RecordingText::kSensor] = "stylus";
  write("o.csv", other.text());
  EXPECT_EQ(refusal_of({"a.csv", "o.csv"}),
            "o.csv:9: field sensor: value 'stylus': expected a sensor of the catheter (tip, shaft), or [recording] "
            "ignore_sensors of the catheter file to name it");
  other = b_;
  other.at(7, "shaft")[RecordingText::kX] = "nan";
  write("o.csv", other.text());
  EXPECT_EQ(refusal_of({"a.csv", "o.csv"}, {"--strict"}),
            "o.csv: frame 7 at 0.583333 s: sensor \"shaft\": not finite (--strict)");
  other = b_;
  other.rows.insert(other.rows.begin() + 4, other.rows[3]);
  write("o.csv", other.text());
  EXPECT_EQ(refusal_of({"a.csv", "o.csv"}, {"--strict"}),
            "o.csv: frame 3 at 0.25 s: sensor \"shaft\": a second row: 1 in all: expected one row a sensor a frame "
            "(--strict)");
  other = b_;
  for (Row& row : other.rows)
    if (std::stoi(row[RecordingText::kFrame]) >= 60)
      row[RecordingText::kTime] = std::to_string(std::stod(row[RecordingText::kTime]) - 60.0);
  write("o.csv", other.text());
  EXPECT_EQ(refusal_of({"a.csv", "o.csv"}),
            "o.csv: frame 65: field time_s: value '-54.583333': expected times that run on after 4.916667 s, for "
            "recordings are merged by time; was the clock set back?");
  EXPECT_EQ(refusal_of({"a.csv", "b.csv"}, {"--reference", "100:101"}),
            "a.csv, b.csv: reference 100:101 s: expected an interval with frames; the recording goes from 0 s to 7.975 "
            "s");
}

}  // namespace
}  // namespace palpate
