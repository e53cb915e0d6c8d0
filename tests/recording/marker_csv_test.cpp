// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <palpate/recording/marker_csv.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/shared_data.hpp>

namespace palpate {
namespace {

using ::testing::ElementsAre;

Sensor marker_sensor(const char* name, SensorKind kind, std::vector<std::string> markers) {
  Sensor sensor;
  sensor.name = name;
  sensor.kind = kind;
  sensor.markers = std::move(markers);
  return sensor;
}

class MarkerCsv : public test::TemporaryFolder {
 protected:
  MarkerRecording parse(std::string_view text) const { return parse_marker_csv(read_text_file(write("m.csv", text))); }
  std::string error(std::string_view text) const {
    return error_of([&] { parse(text); });
  }
};

TEST_F(MarkerCsv, ReadsMetresAndMillimetresAndBlanks) {
  const auto r =
      parse("t_s,a_x_m,a_y_m,a_z_m,b_x_mm,b_y_mm,b_z_mm,a_residual_m\n0,1,2,3,10,20,30,x\n0.01,nan,2,3,,,,\n");
  EXPECT_THAT(r.names, ElementsAre("a", "b"));
  EXPECT_THAT(r.times_s, ElementsAre(0.0, 0.01));
  EXPECT_EQ(r.positions_m[0][0], Vector3d(1, 2, 3));
  EXPECT_TRUE(r.positions_m[0][1].isApprox(Vector3d(0.01, 0.02, 0.03)));
  EXPECT_TRUE(std::isnan(r.positions_m[1][0].x()));
  EXPECT_TRUE(std::isnan(r.positions_m[1][1].z()));
}

TEST_F(MarkerCsv, RefusesWithPlaceValueAndExpectation) {
  EXPECT_EQ(error("t_s,a_x_m,a_y_m\n0,1,2\n"),
            "m.csv:1: field header: value 't_s,a_x_m,a_y_m': expected a column named a_z_m");
  EXPECT_EQ(error("t,a_x_m,a_y_m,a_z_m\n0,1,2,3\n"),
            "m.csv:1: field header: value 't,a_x_m,a_y_m,a_z_m': expected a column named time_s");
  EXPECT_EQ(error("t_s,a_x_m,a_y_m,a_z_m\n0,1,oops,3\n"), "m.csv:2: field a_y_m: value 'oops': expected a number");
  EXPECT_EQ(error("t_s,a_x_m,a_y_m,a_z_m\n"),
            "m.csv:1: field row: value '': expected at least one row after the header");
  EXPECT_EQ(error("t_s,a_x_m,a_y_m,a_z_m,a_x_mm,a_y_mm,a_z_mm\n0,1,2,3,1,2,3\n"),
            "m.csv:1: field header: value 'a_x_mm': expected each marker once, in m or in mm");
}

/// A triad and a pair, moved by one rigid motion in the second frame; the third lacks a marker of each.
class MarkerSensors : public MarkerCsv {
 protected:
  MarkerSensors() {
    recording_.source = "m.csv";
    recording_.names = {"a", "b", "c", "d"};
    const std::vector<Vector3d> still = {{0, 0, 0.1}, {0.03, 0, 0.1}, {0, 0.02, 0.1}, {0.1, 0.2, 0.3}};
    std::vector<Vector3d> moved, lost = still;
    for (const Vector3d& p : still) moved.push_back(motion_ * p);
    lost[1].setConstant(std::nan(""));
    recording_.times_s = {0.0, 1.0, 2.0};
    recording_.positions_m = {still, moved, lost};
    catheter_.sensors = {marker_sensor("tip", SensorKind::kPose, {"a", "b", "c"}),
                         marker_sensor("mid", SensorKind::kPosition, {"b", "d"})};
    catheter_.base.T_tracker_base.R = exp_so3({0.3, -0.2, 0.9});
    catheter_.rod = uniform_rod(0.1, {1e-3, 1e-3, 1e-3}, Vector3d::Zero());
    options_ = {&catheter_, 0.0, 0.5};
  }

  Pose motion_{exp_so3({0.5, 1.0, -0.7}), {0.4, -0.1, 0.2}};
  MarkerRecording recording_;
  Catheter catheter_;
  RecordingOptions options_;
};

TEST_F(MarkerSensors, TriadTurnsWithItsMarkersFromTheBaseAxes) {
  const auto r = assemble_sensors(recording_, options_);
  EXPECT_THAT(r.sensor_names, ElementsAre("tip", "mid"));
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& q = r.frames[i].readings[0].quaternion_wxyz;
    const Matrix3d R = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
    const Matrix3d expected = (i == 0 ? Matrix3d::Identity() : motion_.R) * catheter_.base.T_tracker_base.R;
    EXPECT_TRUE(R.isApprox(expected, 1e-12)) << i;
  }
  const Vector3d centroid(0.01, 0.02 / 3.0, 0.1);
  EXPECT_TRUE(r.frames[1].readings[0].position_m.isApprox(motion_ * centroid, 1e-12));
  EXPECT_TRUE(r.frames[0].readings[1].position_m.isApprox(Vector3d(0.065, 0.1, 0.2), 1e-12));
  EXPECT_FALSE(r.frames[0].readings[1].has_orientation);
  for (const auto& reading : r.frames[2].readings) EXPECT_EQ(reading.status, SensorReading::Status::kMissing);
}

/// An unloaded shaft holds its end turned by k1 L about d1 (a circular arc); held straight, not at all.
TEST_F(MarkerSensors, TriadStartsAsTheUnloadedShaftHoldsIt) {
  catheter_.rod = uniform_rod(0.1, {1e-3, 1e-3, 1e-3}, {20.0, 0.0, 0.0});
  catheter_.sensors[0].arc_length_m = 0.1;
  catheter_.sensors[0].T_local_sensor.R = exp_so3({0.1, 0.2, 0.3});
  for (const bool straight : {false, true}) {
    options_.reference_straight = straight;
    const auto q = assemble_sensors(recording_, options_).frames[0].readings[0].quaternion_wxyz;
    const Matrix3d R_base_local = exp_so3({straight ? 0.0 : 2.0, 0.0, 0.0});
    const Matrix3d expected = catheter_.base.T_tracker_base.R * R_base_local * catheter_.sensors[0].T_local_sensor.R;
    EXPECT_TRUE(Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix().isApprox(expected, 1e-7)) << straight;
  }
}

TEST_F(MarkerSensors, ATrackedBaseComesLast) {
  catheter_.base.tracked = true;
  catheter_.base.sensor = marker_sensor("clamp", SensorKind::kPose, {"b", "c", "d"});
  EXPECT_THAT(assemble_sensors(recording_, options_).sensor_names, ElementsAre("tip", "mid", "clamp"));
}

/// Merged with other recordings it need not hold every sensor; alone it must.
TEST_F(MarkerSensors, SensorsWithoutMarkersStandInAnotherRecording) {
  catheter_.sensors.push_back(marker_sensor("coil", SensorKind::kPose, {}));
  options_.one_of_several = true;
  EXPECT_THAT(assemble_sensors(recording_, options_).sensor_names, ElementsAre("tip", "mid"));
  const auto error_now = [&] { return error_of([&] { assemble_sensors(recording_, options_); }); };
  options_.one_of_several = false;
  EXPECT_EQ(
      error_now(),
      "m.csv: sensor coil: markers = []: expected at least 3 in the catheter file, for this is a marker recording");
  options_.one_of_several = true;
  catheter_.sensors = {marker_sensor("coil", SensorKind::kPose, {})};
  EXPECT_EQ(error_now(), "m.csv: a marker recording: expected a sensor of the catheter file to list markers");
}

TEST_F(MarkerSensors, ATriadOfASecondTrackerTurnsFromItsOwnBaseAxes) {
  catheter_.sensors[0].T_tracker_base = Pose{exp_so3({-1.0, 0.4, 0.2}), {1.0, 2.0, 3.0}};
  const auto q = assemble_sensors(recording_, options_).frames[0].readings[0].quaternion_wxyz;
  EXPECT_TRUE(Eigen::Quaterniond(q[0], q[1], q[2], q[3])
                  .toRotationMatrix()
                  .isApprox(catheter_.sensors[0].T_tracker_base->R, 1e-12));
}

TEST_F(MarkerSensors, RefusesWhatCannotBeMade) {
  const auto error_now = [&] { return error_of([&] { assemble_sensors(recording_, options_); }); };
  options_.reference_from_s = 5.0;
  options_.reference_to_s = 6.0;
  EXPECT_EQ(error_now(),
            "m.csv: sensor tip: reference interval 5..6 s: expected frames in which all its markers are seen "
            "([reference] from_s, to_s in the catheter file, or --reference)");
  options_ = {&catheter_, 0.0, 0.5};
  recording_.positions_m[0][2] = {0.06, 0.0, 0.1};
  EXPECT_EQ(error_now(), "m.csv: sensor tip: markers a, b, c: expected markers that are not on a line, for a pose");
  catheter_.sensors[0].markers = {"a", "e", "c"};
  EXPECT_EQ(error_now(), "m.csv: sensor tip: marker e: expected one of a, b, c, d");
  catheter_.sensors[0].markers = {"a", "b"};
  EXPECT_EQ(error_now(),
            "m.csv: sensor tip: markers = [a, b]: expected at least 3 in the catheter file, for this is a marker "
            "recording");
  options_.catheter = nullptr;
  EXPECT_EQ(error_now(), "m.csv: a marker recording: expected a catheter whose sensors list markers");
}

// wc -l gives 501, 601 and 601 lines with the header.
TEST_F(MarkerCsv, RealBeam) {
  PALPATE_NEEDS_SHARED("data/soft_beam");
  const auto folder = test::shared_data("data/soft_beam");
  Catheter catheter;
  catheter.sensors = {marker_sensor("tip", SensorKind::kPosition, {"tip2", "tip3"}),
                      marker_sensor("end", SensorKind::kPose, {"tip1", "tip2", "tip3"})};
  const RecordingOptions options{
      .catheter = &catheter, .reference_from_s = 0.0, .reference_to_s = 0.195, .reference_straight = true};
  const auto load52 = read_tracker_recording(folder / "beam_load52_V2_a.csv", options);
  EXPECT_EQ(read_tracker_recording(folder / "beam_gravity_V2_a.csv", options).frames.size(), 500u);
  EXPECT_EQ(load52.frames.size(), 600u);
  EXPECT_EQ(read_tracker_recording(folder / "beam_load101_V2_a.csv", options).frames.size(), 600u);
  // The drop from straight to loaded along -x: 16.63 mm in the data's README, of the first 20 and the last 100 frames.
  double before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < 20; ++i) before += load52.frames[i].readings[0].position_m.x() / 20.0;
  for (std::size_t i = 500; i < 600; ++i) after += load52.frames[i].readings[0].position_m.x() / 100.0;
  EXPECT_NEAR(1e3 * (before - after), 16.63, 0.3);
  EXPECT_NEAR(std::abs(load52.frames[0].readings[1].quaternion_wxyz[0]), 1.0, 1e-3);
}

}  // namespace
}  // namespace palpate
