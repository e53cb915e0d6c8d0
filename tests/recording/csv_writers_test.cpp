// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/recording/csv_writers.hpp>
#include <palpate/recording/force_csv.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/sensing/virtual_setups.hpp>

namespace palpate {
namespace {

class CsvWriters : public test::TemporaryFolder {
 protected:
  Catheter catheter_ = test::with_tracked_base(test::mixed_sensors());
  VirtualRecording recording_ =
      simulate_tracker(catheter_, beating_wall_force, {.duration_s = 2.0, .missing_share = 0.1, .outlier_share = 0.02});
};

/// Micrometres, and 1e-6 in a quaternion: half of the last digit, and a little for reading decimal numbers.
TEST_F(CsvWriters, TrackerRecordingIsReadAsItWasWritten) {
  write_tracker_csv(path("r.csv"), catheter_, recording_.frames);
  TrackerRecording read = read_tracker_recording(path("r.csv"));
  bind_to_catheter(read, catheter_);
  EXPECT_EQ(read.sensor_names, (std::vector<std::string>{"tip", "needle", "marker", "base"}));
  ASSERT_EQ(read.frames.size(), recording_.frames.size());
  for (std::size_t i = 0; i < read.frames.size(); ++i) {
    const TrackerFrame &a = read.frames[i], &b = recording_.frames[i];
    EXPECT_EQ(a.number, b.number);
    EXPECT_NEAR(a.time_s, b.time_s, 0.5001e-6);
    ASSERT_EQ(a.readings.size(), b.readings.size());
    for (std::size_t k = 0; k < a.readings.size(); ++k) {
      EXPECT_EQ(a.readings[k].status, b.readings[k].status);
      if (b.readings[k].status == SensorReading::Status::kMissing) continue;
      EXPECT_EQ(a.readings[k].has_orientation, b.readings[k].has_orientation);
      EXPECT_LT((a.readings[k].position_m - b.readings[k].position_m).cwiseAbs().maxCoeff(), 0.5001e-6);
      EXPECT_LT((a.readings[k].quaternion_wxyz - b.readings[k].quaternion_wxyz).cwiseAbs().maxCoeff(), 0.5001e-6);
    }
  }
}

TEST_F(CsvWriters, HeaderAndRowsAreTheContracts) {
  Catheter catheter = test::bare_catheter();
  catheter.sensors = {test::sensor_at("tip", 0.07), test::sensor_at("dot", 0.05, SensorKind::kPosition),
                      test::sensor_at("gone", 0.03), test::sensor_at("elsewhere", 0.02)};
  TrackerFrame frame{.time_s = 0.025, .number = 1};
  frame.readings = {test::reading_of({Matrix3d::Identity(), {0.0105, -0.02, 0.1}}),
                    test::reading_of({Matrix3d::Identity(), {0.001, 0.0, 0.0}}, SensorKind::kPosition),
                    SensorReading{},
                    {.status = SensorReading::Status::kAbsent}};
  write_tracker_csv(path("r.csv"), catheter, std::vector{frame});
  EXPECT_EQ(contents(path("r.csv")),
            "time_s,frame,sensor,status,q0,qx,qy,qz,tx_mm,ty_mm,tz_mm,error_mm\n"
            "0.025000,1,tip,OK,1.000000,0.000000,0.000000,0.000000,10.500,-20.000,100.000,\n"
            "0.025000,1,dot,OK,,,,,1.000,0.000,0.000,\n"
            "0.025000,1,gone,MISSING,,,,,,,,\n");
}

TEST_F(CsvWriters, ForcesAreReadAsTheyWereWritten) {
  write_force_csv(path("f.csv"), recording_.frames, recording_.force_tip_N, recording_.force_base_N);
  const ForceTrace read = read_force_csv(path("f.csv"));
  ASSERT_EQ(read.times_s.size(), recording_.frames.size());
  ASSERT_EQ(read.force_base_N.size(), recording_.frames.size());
  for (std::size_t i = 0; i < read.times_s.size(); ++i) {
    EXPECT_NEAR(read.times_s[i], recording_.frames[i].time_s, 0.5001e-6);
    EXPECT_LT((read.force_tip_N[i] - recording_.force_tip_N[i]).norm(), 1e-9);
    EXPECT_LT((read.force_base_N[i] - recording_.force_base_N[i]).norm(), 1e-9);
  }
}

TEST_F(CsvWriters, FolderThatIsNotThereIsNamed) {
  const std::string error = error_of([&] { write_tracker_csv(path("no/r.csv"), catheter_, recording_.frames); });
  EXPECT_TRUE(error.starts_with("no/r.csv: cannot be written")) << error;
}

}  // namespace
}  // namespace palpate
