// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/recording/tracker_recording.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/shared_data.hpp>

namespace palpate {
namespace {

using ::testing::ElementsAre;

class MrCoilText : public test::TemporaryFolder {};

TEST_F(MrCoilText, CoilsOfOneRecordingFormFramesByTime) {
  write("cathcoords-coil7-0000.txt", "1 2 3 40 1000 5 -0.2\n4 5 6 40 1050 5 -0.2\n");
  write("cathcoords-coil6-0000.txt", "7 8 9 1.5 1000 5 -0.2\n7 8 nan 1.5 1075 5 -0.2\n");
  write("cathcoords-coil6-0001.txt", "0 0 0 0 0 0 0\n");
  const auto r = read_tracker_recording(path("cathcoords-coil7-0000.txt"));
  EXPECT_THAT(r.sensor_names, ElementsAre("coil6", "coil7"));
  ASSERT_EQ(r.frames.size(), 3u);
  EXPECT_NEAR(r.frames[1].time_s, 0.05, 1e-12);
  EXPECT_EQ(r.frames[0].readings[0].status, SensorReading::Status::kOk);  // a low SNR is not judged here
  EXPECT_FALSE(r.frames[0].readings[0].has_orientation);
  EXPECT_TRUE(r.frames[0].readings[1].position_m.isApprox(Eigen::Vector3d(0.001, 0.002, 0.003)));
  EXPECT_EQ(r.frames[1].readings[0].status, SensorReading::Status::kAbsent);
  EXPECT_EQ(r.frames[2].readings[1].status, SensorReading::Status::kAbsent);
  EXPECT_TRUE(std::isnan(r.frames[2].readings[0].position_m.z()));
}

TEST_F(MrCoilText, AFolderMustHoldOneRecording) {
  const std::string none = error_of([&] { read_tracker_recording(path("")); });
  EXPECT_NE(none.find("MR coil text named cathcoords-coil<K>-<REC>.txt in it"), std::string::npos) << none;
  write("cathcoords-coil1-0000.txt", "1 2 3 40 1000 5 -0.2\n");
  EXPECT_EQ(read_tracker_recording(path("")).frames.size(), 1u);
  write("cathcoords-coil1-0001.txt", "1 2 3 40 1000 5 -0.2\n");
  const std::string message = error_of([&] { read_tracker_recording(path("")); });
  EXPECT_NE(message.find("holds the recordings 0000, 0001: expected one; name a file of the one you mean"),
            std::string::npos)
      << message;
}

TEST_F(MrCoilText, RefusesWithPlaceValueAndExpectation) {
  const auto error = [&](const char* text) {
    return error_of([&] { read_tracker_recording(write("cathcoords-coil1-0.txt", text)); });
  };
  EXPECT_EQ(error("1 2 3 4 5 6 7\n1 2 x 4 5 6 7\n"), "cathcoords-coil1-0.txt:2: field Z: value 'x': expected a number");
  EXPECT_EQ(error("1 2 3\n1 2 3 4 5 6 7\n"),
            "cathcoords-coil1-0.txt:1: field row: value '1 2 3': expected 7 numbers, found 3");
  EXPECT_EQ(error("1 2 3 4 5 6 7\n1 2"),
            "cathcoords-coil1-0.txt:2: field row: value '1 2': expected 7 numbers, found 2 (truncated last row)");
  EXPECT_EQ(error("1 2 3 4 nan 6 7\n"),
            "cathcoords-coil1-0.txt:1: field time: value 'nan': expected a time in milliseconds since the epoch");
  EXPECT_EQ(error_of([&] { read_tracker_recording(path("cathcoords-coil9-9.txt")); }),
            "cathcoords-coil9-9.txt: cannot be opened: No such file or directory: expected a readable text file");
}

struct Scatter {
  double mean_mm = 0.0;
  double sigma_mm = 0.0;
};

Scatter coil_distance(const TrackerRecording& r, std::size_t a, std::size_t b) {
  double sum = 0.0, squares = 0.0;
  for (const auto& frame : r.frames) {
    const double d = 1e3 * (frame.readings[a].position_m - frame.readings[b].position_m).norm();
    sum += d;
    squares += d * d;
  }
  const double n = static_cast<double>(r.frames.size());
  return {sum / n, std::sqrt(squares / n - sum * sum / (n * n))};
}

// Rows by wc, mean and scatter of the distance by awk: 7.966 +- 0.382 mm and 7.443 +- 0.276 mm; the truth is 7.67 mm.
TEST_F(MrCoilText, RealCatheter) {
  PALPATE_NEEDS_SHARED("data/mr_catheter");
  const auto folder = test::shared_data("data/mr_catheter/SRI_April-2020-07-09T12_20_56.765");
  const auto first = read_tracker_recording(folder / "cathcoords-coil7-0000.txt");
  const auto second = read_tracker_recording(folder / "cathcoords-coil0-0001.txt");
  EXPECT_EQ(first.frames.size(), 103u);
  EXPECT_EQ(second.frames.size(), 114u);
  ASSERT_EQ(first.sensor_names.size(), 8u);
  for (const auto* r : {&first, &second}) {
    const Scatter distance = coil_distance(*r, 6, 7);
    EXPECT_NEAR(distance.mean_mm, 7.67, distance.sigma_mm);
  }
  EXPECT_NEAR(coil_distance(first, 6, 7).mean_mm, 7.96559, 1e-4);
  EXPECT_NEAR(coil_distance(second, 6, 7).mean_mm, 7.44292, 1e-4);
  EXPECT_NE(error_of([&] { read_tracker_recording(folder); }), "no error");
}

}  // namespace
}  // namespace palpate
