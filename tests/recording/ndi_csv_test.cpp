// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <palpate/recording/tracker_recording.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/shared_data.hpp>

namespace palpate {
namespace {

using ::testing::ElementsAre;

constexpr std::string_view kPreamble =
    "Test Date: \r\nday, month, year, hour, minute, second, milliseconds\r\n2, 2, 2021, 4, 15 , 52 , 821 \r\n\r\n"
    "Sample:,Hour,Minutes,Seconds,ms,Xa,Ya,Za,qoa,qxa,qya,qza,Xb,Yb,Zb,qob,qxb,qyb,qzb\r\n";
constexpr std::string_view kUnseen = "0, 0, 0, 0, 0, 0, 0, ";
constexpr std::string_view kSeen = "10.5 , -20.0 , 30.0, 0.5 , 0.5 , 0.5, 0.5, ";

class NdiCsv : public test::TemporaryFolder {
 protected:
  TrackerRecording read(const std::string& rows) const {
    return read_tracker_recording(write("n.csv", std::string(kPreamble).append(rows)));
  }
};

std::string row(const std::string& sample, const std::string& time, std::string_view a, std::string_view b) {
  return sample + ", " + time + "," + std::string(a) + std::string(b) + "\r\n";
}

TEST_F(NdiCsv, SevenZerosAreMissingAndTimeStartsAtTheFirstRow) {
  const auto r = read(row("1", "4 , 15 , 52, 821", kUnseen, kSeen) + row("2", "4 , 15 , 52, 866", kSeen, kSeen));
  EXPECT_THAT(r.sensor_names, ElementsAre("a", "b"));
  ASSERT_EQ(r.frames.size(), 2u);
  EXPECT_EQ(r.frames[0].readings[0].status, SensorReading::Status::kMissing);
  EXPECT_TRUE(r.frames[0].readings[1].position_m.isApprox(Eigen::Vector3d(0.0105, -0.020, 0.030)));
  EXPECT_TRUE(r.frames[0].readings[1].quaternion_wxyz.isApprox(Eigen::Vector4d::Constant(0.5)));
  EXPECT_EQ(r.frames[0].time_s, 0.0);
  EXPECT_NEAR(r.frames[1].time_s, 0.045, 1e-9);
  EXPECT_EQ(r.frames[1].number, 2);
}

TEST_F(NdiCsv, MidnightIsBridgedAndASmallStepBackKept) {
  const auto r = read(row("1", "23,59,59,900", kSeen, kSeen) + row("2", "0,0,0,100", kSeen, kSeen) +
                      row("3", "0,0,0,50", kSeen, kSeen));
  EXPECT_NEAR(r.frames[1].time_s, 0.2, 1e-9);
  EXPECT_NEAR(r.frames[2].time_s, 0.15, 1e-9);
}

TEST_F(NdiCsv, ATruncatedLastRowIsReadAsFarAsItsSensorsAreWhole) {
  const auto r = read(row("1", "4,15,52,821", kSeen, kSeen) + "2,4,15,52,866," + std::string(kSeen) + "10.5, 2");
  ASSERT_EQ(r.frames.size(), 2u);
  EXPECT_EQ(r.frames[1].readings[0].status, SensorReading::Status::kOk);
  EXPECT_EQ(r.frames[1].readings[1].status, SensorReading::Status::kMissing);
  EXPECT_THAT(r.notes, ElementsAre("line 7: truncated last row, read as far as it is whole"));
  const auto no_time = read(row("1", "4,15,52,821", kSeen, kSeen) + "2,4,15,52,8");
  EXPECT_EQ(no_time.frames.size(), 1u);
}

TEST_F(NdiCsv, RefusesWithPlaceValueAndExpectation) {
  const auto error = [&](const std::string& rows) { return error_of([&] { read(rows); }); };
  EXPECT_EQ(error("1,4,15,52,821,1,2\r\n" + row("2", "4,15,52,866", kSeen, kSeen)),
            "n.csv:6: field row: value '1,4,15,52,821,1,2': expected 19 fields, found 7");
  EXPECT_EQ(error(row("1", "4,x,52,821", kSeen, kSeen)), "n.csv:6: field Minutes: value 'x': expected a number");
  EXPECT_EQ(error(row("1", "4,1,52,821", "1,2,3,a,0,0,0,", kSeen)), "n.csv:6: field qoa: value 'a': expected a number");
  EXPECT_EQ(error(""), "n.csv:5: field row: value '': expected at least one row after the header");
  EXPECT_EQ(
      error_of([&] { read_tracker_recording(write("h.csv", "Test Date:\nSample:,Hour,Minutes,Seconds,ms,Xa,Za\n")); }),
      "h.csv:2: field header: value 'Za': expected column 7 to be Ya");
  EXPECT_EQ(error_of([&] { read_tracker_recording(write("h.csv", "Test Date:\nnothing\n")); }),
            "h.csv:2: field header: value '': expected a line that starts with 'Sample:' after the preamble");
}

// Counted with awk: 159 rows, the last without sensors; rows of zeros of sensors a..d.
TEST_F(NdiCsv, RealRecording) {
  PALPATE_NEEDS_SHARED("data/ndi_aurora");
  const auto r = read_tracker_recording(test::shared_data("data/ndi_aurora/NDIdata_snakeravenTest_2_2_21.csv"));
  EXPECT_EQ(r.frames.size(), 159u);
  std::vector<int> missing(4, 0);
  for (const auto& frame : r.frames) {
    for (std::size_t i = 0; i < 4; ++i) missing[i] += frame.readings[i].status == SensorReading::Status::kMissing;
  }
  EXPECT_THAT(missing, ElementsAre(3, 5, 10, 2));
  EXPECT_THAT(r.notes, ElementsAre("line 164: truncated last row, read as far as it is whole"));
  EXPECT_NEAR(r.frames[157].time_s, 7.381, 1e-9);  // 4:16:00.202 - 4:15:52.821
}

}  // namespace
}  // namespace palpate
