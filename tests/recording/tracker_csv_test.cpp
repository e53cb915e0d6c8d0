// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/recording/tracker_recording.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/shared_data.hpp>

namespace palpate {
namespace {

constexpr std::string_view kHeader = "time_s,frame,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm,error_mm\n";

class TrackerCsv : public test::TemporaryFolder {
 protected:
  TrackerRecording read(std::string_view rows) const {
    return read_tracker_recording(write("r.csv", std::string(kHeader).append(rows)));
  }
  std::string error(std::string_view rows) const {
    return error_of([&] { read(rows); });
  }
};

std::size_t count_missing(const TrackerRecording& recording, std::size_t sensor) {
  std::size_t missing = 0;
  for (const TrackerFrame& frame : recording.frames) {
    missing += frame.readings[sensor].status == SensorReading::Status::kMissing ? 1 : 0;
  }
  return missing;
}

std::size_t count_broken(const TrackerRecording& recording, std::size_t sensor) {
  std::size_t broken = 0;
  for (const TrackerFrame& frame : recording.frames) {
    const SensorReading& reading = frame.readings[sensor];
    broken += reading.status == SensorReading::Status::kOk && !reading.position_m.allFinite() ? 1 : 0;
  }
  return broken;
}

TEST_F(TrackerCsv, ReadsFramesOfNamedSensors) {
  const auto r =
      read("0.5,7,tip,OK,1,0,0,0,10,20,30,0.1\n0.5,7,shaft,MISSING,,,,,,,,\n0.525,8,shaft,OK,0,1,0,0,1,2,3,\n");
  EXPECT_EQ(r.sensor_names, (std::vector<std::string>{"tip", "shaft"}));
  EXPECT_EQ(r.sensor_lines, (std::vector<std::size_t>{2, 3}));
  ASSERT_EQ(r.frames.size(), 2u);
  EXPECT_EQ(r.frames[0].number, 7);
  EXPECT_EQ(r.frames[0].time_s, 0.5);
  EXPECT_EQ(r.frames[0].readings[0].position_m, Eigen::Vector3d(0.010, 0.020, 0.030));
  EXPECT_DOUBLE_EQ(r.frames[0].readings[0].error_m, 0.1e-3);
  EXPECT_TRUE(r.frames[0].readings[0].has_orientation);
  EXPECT_EQ(r.frames[0].readings[1].status, SensorReading::Status::kMissing);
  EXPECT_EQ(r.frames[1].readings[0].status, SensorReading::Status::kAbsent);
  EXPECT_EQ(r.frames[1].readings[1].quaternion_wxyz, Eigen::Vector4d(0, 1, 0, 0));
  EXPECT_TRUE(std::isnan(r.frames[1].readings[1].error_m));
  EXPECT_TRUE(r.notes.empty());
}

TEST_F(TrackerCsv, ASensorWithoutARowIsAbsentNotMissing) {
  const auto r = read(
      "0,0,tip,OK,1,0,0,0,1,2,3,\n1,1,tip,MISSING,,,,,,,,\n1,1,extra,OK,1,0,0,0,1,2,3,\n2,2,shaft,OK,1,0,0,0,1,2,3,\n");
  using enum SensorReading::Status;
  const std::vector<std::vector<SensorReading::Status>> expected = {
      {kOk, kAbsent, kAbsent}, {kMissing, kOk, kAbsent}, {kAbsent, kAbsent, kOk}};
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(r.frames.at(i).readings.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(r.frames[i].readings[k].status, expected[i][k]) << i << k;
  }
}

TEST_F(TrackerCsv, HeaderOrderIsFreeAndErrorColumnOptional) {
  const auto r = read_tracker_recording(write(
      "r.csv", "tz_mm,ty_mm,tx_mm,qz,qy,qx,q0,status,sensor,frame,time_s,colour\r\n3,2,1,0,0,0,1,OK,tip,0,0,red"));
  EXPECT_EQ(r.frames.at(0).readings.at(0).position_m, Eigen::Vector3d(0.001, 0.002, 0.003));
  EXPECT_EQ(r.notes, std::vector<std::string>{"column colour is not read"});
}

TEST_F(TrackerCsv, NumbersThatAreNotFinitePassOn) {
  const auto r = read("nan,0,tip,OK,1,0,0,0,nan,inf,3,\n1,1,tip,OK,NaN,-Inf,0,0,1,2,3,\n");
  EXPECT_TRUE(std::isnan(r.frames[0].time_s));
  EXPECT_TRUE(std::isnan(r.frames[0].readings[0].position_m.x()));
  EXPECT_TRUE(std::isnan(r.frames[0].readings[0].position_m.y()));
  EXPECT_TRUE(std::isnan(r.frames[1].readings[0].quaternion_wxyz[1]));
  EXPECT_EQ(r.frames[0].readings[0].status, SensorReading::Status::kOk);
}

TEST_F(TrackerCsv, RowsWithoutQuaternionArePoints) {
  const auto r = read("0,0,tip,OK,,,,,1,2,3,\n0,0,shaft,OK,1,0,0,0,4,5,6,\n");
  EXPECT_EQ(r.frames[0].readings[0].status, SensorReading::Status::kOk);
  EXPECT_FALSE(r.frames[0].readings[0].has_orientation);
  EXPECT_EQ(r.frames[0].readings[0].position_m, Eigen::Vector3d(0.001, 0.002, 0.003));
  EXPECT_TRUE(r.frames[0].readings[1].has_orientation);
  EXPECT_EQ(error("0,0,tip,OK,1,,,,1,2,3,\n"), "r.csv:2: field qx: value '': expected a number");
  EXPECT_EQ(error("0,0,tip,OK,,,,,,,,\n"), "r.csv:2: field tx_mm: value '': expected a number");
}

TEST_F(TrackerCsv, FirstOfDuplicateRowsIsKept) {
  const auto r = read(
      "0,0,tip,OK,1,0,0,0,1,2,3,\n0,0,tip,OK,1,0,0,0,9,9,9,\n0,0,tip,MISSING,,,,,,,,\n0.1,1,tip,OK,1,0,0,0,4,5,6,\n"
      "9,0,tip,OK,1,0,0,0,9,9,9,\n");
  EXPECT_EQ(r.frames.size(), 2u);
  EXPECT_EQ(r.duplicate_rows, 3u);
  EXPECT_EQ(r.frames[0].readings[0].position_m.x(), 0.001);
  EXPECT_EQ(r.first_duplicate, "frame 0 at 0 s: sensor \"tip\": a second row");
  EXPECT_EQ(r.notes, std::vector<std::string>{"line 6: frame 0 comes again with another time; counted as a duplicate"});
}

TEST_F(TrackerCsv, FramesStayInFileOrder) {
  const auto r = read("1,5,tip,OK,1,0,0,0,1,2,3,\n0.5,4,tip,OK,1,0,0,0,1,2,3,\n1,6,tip,OK,1,0,0,0,1,2,3,\n");
  ASSERT_EQ(r.frames.size(), 3u);
  EXPECT_EQ(r.frames[0].time_s, 1.0);
  EXPECT_EQ(r.frames[1].time_s, 0.5);
  EXPECT_EQ(r.frames[2].time_s, 1.0);
}

TEST_F(TrackerCsv, RefusesWithPlaceValueAndExpectation) {
  EXPECT_EQ(error("0,0,tip,OK,1,0,0,0,abc,2,3,\n"), "r.csv:2: field tx_mm: value 'abc': expected a number");
  EXPECT_EQ(error("0,0,tip,OK,1,0,0,,1,2,3,\n"), "r.csv:2: field qz: value '': expected a number");
  EXPECT_EQ(error("0,0,tip,GOOD,1,0,0,0,1,2,3,\n"), "r.csv:2: field status: value 'GOOD': expected OK or MISSING");
  EXPECT_EQ(error("0,x,tip,OK,1,0,0,0,1,2,3,\n"), "r.csv:2: field frame: value 'x': expected an integer");
  EXPECT_EQ(error("0,nan,tip,OK,1,0,0,0,1,2,3,\n"), "r.csv:2: field frame: value 'nan': expected an integer");
  EXPECT_EQ(error(",0,tip,OK,1,0,0,0,1,2,3,\n"), "r.csv:2: field time_s: value '': expected a number");
  EXPECT_EQ(error("0,0,,OK,1,0,0,0,1,2,3,\n"), "r.csv:2: field sensor: value '': expected the name of a sensor");
  EXPECT_EQ(error("0,0,tip,OK,1,0,0,0,1,2,3,1mm\n"), "r.csv:2: field error_mm: value '1mm': expected a number");
  EXPECT_EQ(error("0,0,tip,OK,1,0,0,0,1,2,3,\n0.1,0,shaft,OK,1,0,0,0,1,2,3,\n"),
            "r.csv:3: field time_s: value '0.1': expected 0, the time of the other rows of frame 0");
  EXPECT_EQ(error("0,0,tip,OK,1,0,0,0,1,2,3,\n0.1,1,tip,OK,1,0"),
            "r.csv:3: field row: value '0.1,1,tip,OK,1,0': expected 12 fields, found 6 (truncated last row)");
  EXPECT_EQ(error(""), "r.csv:1: field row: value '': expected at least one row after the header");
}

TEST_F(TrackerCsv, RefusesAHeaderWithoutAColumn) {
  const auto file = write("r.csv", "time_s,frame,sensor,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm\n");
  EXPECT_EQ(error_of([&] { read_tracker_recording(file); }),
            "r.csv:1: field header: value 'time_s,frame,sensor,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm': expected a column named "
            "status");
}

TEST_F(TrackerCsv, UnknownFormatListsWhatIsRead) {
  const std::string message = error_of([&] { read_tracker_recording(write("x.txt", "\nhello\n")); });
  EXPECT_TRUE(message.starts_with("x.txt:2: field header: value 'hello': expected tracker CSV")) << message;
  for (const char* format : {".igs.mha", "NDI CSV", "marker CSV", "cathcoords-coil<K>-<REC>.txt"}) {
    EXPECT_NE(message.find(format), std::string::npos) << format;
  }
}

TEST_F(TrackerCsv, BinaryRubbishIsRefusedNotRead) {
  std::string rubbish;
  for (int i = 0; i < 5000; ++i) rubbish.push_back(static_cast<char>((i * 7919 + i / 3) & 0xff));
  const auto file = write("rubbish.bin", rubbish);
  EXPECT_NE(error_of([&] { read_tracker_recording(file); }), "no error");
  EXPECT_NE(error(rubbish), "no error");
}

/// A catheter with these shaft sensors, and a tracked base where named.
Catheter catheter_with(std::initializer_list<const char*> names, const char* base = nullptr) {
  Catheter catheter;
  for (const char* name : names) catheter.sensors.emplace_back().name = name;
  catheter.base.tracked = base != nullptr;
  if (base != nullptr) catheter.base.sensor.name = base;
  return catheter;
}

TEST_F(TrackerCsv, BindingFollowsTheCatheterAndPutsTheBaseLast) {
  auto r = read(
      "0,0,clamp,OK,1,0,0,0,1,0,0,\n0,0,extra,OK,1,0,0,0,2,0,0,\n0,0,tip,OK,1,0,0,0,3,0,0,\n"
      "0,0,shaft,OK,1,0,0,0,4,0,0,\n");
  bind_to_catheter(r, catheter_with({"tip", "shaft"}, "clamp"), {"extra"});
  EXPECT_EQ(r.sensor_names, (std::vector<std::string>{"tip", "shaft", "clamp"}));
  EXPECT_EQ(r.sensor_lines, (std::vector<std::size_t>{4, 5, 2}));
  ASSERT_EQ(r.frames[0].readings.size(), 3u);
  EXPECT_EQ(r.frames[0].readings[0].position_m.x(), 0.003);
  EXPECT_EQ(r.frames[0].readings[2].position_m.x(), 0.001);
}

TEST_F(TrackerCsv, BindingRefusesStrangersAndAbsentSensors) {
  auto r = read("0,0,tip,OK,1,0,0,0,3,0,0,\n0,0,stylus,OK,1,0,0,0,4,0,0,\n");
  EXPECT_EQ(error_of([&] {
              bind_to_catheter(r, catheter_with({"tip", "shaft"}));
            }),
            "r.csv:3: field sensor: value 'stylus': expected a sensor of the catheter (tip, shaft), or [recording] "
            "ignore_sensors of the catheter file to name it");
  EXPECT_EQ(error_of([&] {
              bind_to_catheter(r, catheter_with({"tip", "shaft"}), {"stylus"});
            }),
            "r.csv: field sensor: value 'shaft': expected this sensor of the catheter to occur; the recording has tip, "
            "stylus");
}

// Counts by awk over the files: rows, MISSING and nan of each sensor.
TEST_F(TrackerCsv, SharedRecordings) {
  PALPATE_NEEDS_SHARED("recordings");
  for (const char* name : {"recordings/weight_planar.tracker.csv", "recordings/heartbeat.tracker.csv"}) {
    const auto r = read_tracker_recording(test::shared_data(name));
    EXPECT_EQ(r.sensor_names, (std::vector<std::string>{"tip", "shaft"}));
    EXPECT_EQ(r.frames.size(), 1200u);
    EXPECT_EQ(count_missing(r, 0) + count_missing(r, 1) + count_broken(r, 0) + count_broken(r, 1), 0u);
  }
  const auto faults = read_tracker_recording(test::shared_data("recordings/faults.tracker.csv"));
  EXPECT_EQ(faults.frames.size(), 1200u);
  EXPECT_EQ(count_missing(faults, 0), 52u);
  EXPECT_EQ(count_missing(faults, 1), 54u);
  EXPECT_EQ(count_broken(faults, 0), 3u);
  EXPECT_EQ(count_broken(faults, 1), 5u);
  EXPECT_DOUBLE_EQ(faults.frames.back().time_s, 29.975);
}

}  // namespace
}  // namespace palpate
