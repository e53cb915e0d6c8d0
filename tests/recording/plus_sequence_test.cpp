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

constexpr std::string_view kStart = "ObjectType = Image\nDimSize = 0 0 2\n";
constexpr std::string_view kEnd = "ElementDataFile = LOCAL\n\x01\x02 Seq_Frame0009_XToTrackerTransform = pixels";
constexpr std::string_view kQuarterTurn = "0 -1 0 10 1 0 0 20 0 0 1 30 0 0 0 1";

class PlusSequence : public test::TemporaryFolder {
 protected:
  TrackerRecording read(const std::string& fields) const {
    return read_tracker_recording(write("s.igs.mha", std::string(kStart).append(fields).append(kEnd)));
  }
  std::string error(const std::string& fields) const {
    return error_of([&] { read(fields); });
  }
};

std::string transform(int frame, const std::string& name, std::string_view matrix) {
  return "Seq_Frame000" + std::to_string(frame) + "_" + name + "Transform = " + std::string(matrix) + "\n";
}

std::string time_of(int frame, const std::string& time) {
  return "Seq_Frame000" + std::to_string(frame) + "_Timestamp = " + time + "\n";
}

std::size_t count_missing(const TrackerRecording& recording) {
  std::size_t missing = 0;
  for (const TrackerFrame& frame : recording.frames) {
    for (const auto& reading : frame.readings) missing += reading.status == SensorReading::Status::kMissing ? 1 : 0;
  }
  return missing;
}

TEST_F(PlusSequence, ReadsTransformsAndNeverThePixels) {
  const auto r = read(transform(0, "TipToTracker", kQuarterTurn) + "Seq_Frame0000_TipToTrackerTransformStatus = OK\n" +
                      transform(0, "TipToShaft", kQuarterTurn) + time_of(0, "12.5") + "Seq_Frame0000_Stylus = 1 0\n" +
                      "Seq_Frame0000_UnfilteredTimestamp = 12.4\n");
  EXPECT_THAT(r.sensor_names, ElementsAre("TipToShaft", "Tip"));
  ASSERT_EQ(r.frames.size(), 1u);
  EXPECT_EQ(r.frames[0].time_s, 12.5);
  const SensorReading& tip = r.frames[0].readings[1];
  EXPECT_EQ(tip.status, SensorReading::Status::kOk);
  EXPECT_TRUE(tip.position_m.isApprox(Eigen::Vector3d(0.01, 0.02, 0.03)));
  const double half = std::sqrt(0.5);
  EXPECT_TRUE(tip.quaternion_wxyz.isApprox(Eigen::Vector4d(half, 0, 0, half), 1e-12));
  EXPECT_THAT(r.notes, ElementsAre("line 7: field Stylus is not a transform; not read"));
}

TEST_F(PlusSequence, InvalidAndAllZeroAreMissingAndNoStatusIsOk) {
  const auto r = read(transform(0, "AToTracker", kQuarterTurn) + "Seq_Frame0000_AToTrackerTransformStatus = INVALID\n" +
                      transform(0, "BToTracker", "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0") +
                      transform(0, "CToTracker", kQuarterTurn) + time_of(0, "0"));
  EXPECT_EQ(r.frames[0].readings[0].status, SensorReading::Status::kMissing);
  EXPECT_EQ(r.frames[0].readings[1].status, SensorReading::Status::kMissing);
  EXPECT_EQ(r.frames[0].readings[2].status, SensorReading::Status::kOk);
}

TEST_F(PlusSequence, RoundedRotationIsRepairedAndABrokenOneLeftToScreening) {
  const auto r = read(transform(0, "AToTracker", "0.001 -1.0009 0 1 1.0004 0 0 2 0 0 0.9995 3 0 0 0 1") +
                      transform(0, "BToTracker", "2 0 0 1 0 2 0 2 0 0 2 3 0 0 0 1") +
                      transform(0, "CToTracker", "nan 0 0 1 0 1 0 inf 0 0 1 3 0 0 0 1") +
                      transform(0, "DToTracker", "-1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1") + time_of(0, "0"));
  const auto& readings = r.frames[0].readings;
  EXPECT_NEAR(readings[0].quaternion_wxyz.norm(), 1.0, 1e-14);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_EQ(readings[i].status, SensorReading::Status::kOk) << i;
    EXPECT_TRUE(readings[i].quaternion_wxyz.isZero(0.0)) << i;
  }
  EXPECT_TRUE(std::isnan(readings[2].position_m.y()));
}

TEST_F(PlusSequence, GapsInFrameNumbersAreLostFrames) {
  const auto r = read(transform(0, "AToTracker", kQuarterTurn) + time_of(0, "0") + "Seq_Frame0000_FrameNumber = 10 \n" +
                      transform(1, "AToTracker", kQuarterTurn) + time_of(1, "1") + "Seq_Frame0001_FrameNumber = 14\n");
  EXPECT_EQ(r.frames[0].number, 10);
  EXPECT_EQ(r.frames[1].number, 14);
  EXPECT_THAT(r.notes, ElementsAre("frames_lost: 3 by gaps in FrameNumber"));
}

TEST_F(PlusSequence, ATruncatedHeaderIsReadAsFarAsItIsWhole) {
  const auto r = read_tracker_recording(
      write("cut.igs.mha", std::string(kStart) + transform(0, "AToTracker", kQuarterTurn) + time_of(0, "0") +
                               time_of(1, "1") + "Seq_Frame0001_AToTrackerTransform = 0 -1"));
  ASSERT_EQ(r.frames.size(), 2u);
  EXPECT_EQ(r.frames[1].readings[0].status, SensorReading::Status::kMissing);
  EXPECT_THAT(r.notes,
              ElementsAre("line 6: the file ends before ElementDataFile: truncated, read as far as it is whole"));
  const auto earlier =
      read_tracker_recording(write("cut.igs.mha", std::string(kStart) + transform(0, "AToTracker", kQuarterTurn) +
                                                      time_of(0, "0") + transform(1, "AToTracker", kQuarterTurn)));
  EXPECT_EQ(earlier.frames.size(), 1u);
}

TEST_F(PlusSequence, RefusesWithPlaceValueAndExpectation) {
  EXPECT_EQ(
      error(transform(0, "AToTracker", "1 2 3") + time_of(0, "0")),
      "s.igs.mha:3: field Seq_Frame0000_AToTrackerTransform: value '1 2 3': expected 16 numbers, a row-major 4x4");
  EXPECT_EQ(error(transform(0, "AToTracker", "x -1 0 10 1 0 0 20 0 0 1 30 0 0 0 1") + time_of(0, "0")),
            "s.igs.mha:3: field Seq_Frame0000_AToTrackerTransform: value 'x -1 0 10 1 0 0 20 0 0 1 30 0 0 0 1': "
            "expected 16 numbers, a row-major 4x4");
  EXPECT_EQ(error(transform(0, "AToTracker", kQuarterTurn) + time_of(0, "soon")),
            "s.igs.mha:4: field Seq_Frame0000_Timestamp: value 'soon': expected a time in seconds");
  EXPECT_EQ(error(transform(0, "AToTracker", kQuarterTurn)),
            "s.igs.mha:3: field Seq_Frame0000_Timestamp: value '': expected a time in seconds");
  EXPECT_EQ(error(transform(0, "AToTracker", kQuarterTurn) + "Seq_Frame0000_AToTrackerTransformStatus = HM\n" +
                  time_of(0, "0")),
            "s.igs.mha:4: field Seq_Frame0000_AToTrackerTransformStatus: value 'HM': expected OK or INVALID");
  EXPECT_EQ(error("Seq_FrameXX_Timestamp = 1\n"),
            "s.igs.mha:3: field name: value 'Seq_FrameXX_Timestamp': expected Seq_FrameNNNN_FIELD");
  EXPECT_EQ(error("nonsense\n"), "s.igs.mha:3: field header: value 'nonsense': expected NAME = VALUE");
  EXPECT_EQ(error(time_of(0, "1") + time_of(0, "2")),
            "s.igs.mha:4: field Seq_Frame0000_Timestamp: value '2': expected each field of a frame once");
  EXPECT_EQ(error(""),
            "s.igs.mha:3: field Seq_FrameNNNN_<From>To<To>Transform: value '': expected at least one transform");
}

// Frames, statuses and frame-number gaps counted with grep and awk.
TEST_F(PlusSequence, RealRecordings) {
  PALPATE_NEEDS_SHARED("data/plus_tracker");
  const auto folder = test::shared_data("data/plus_tracker");
  const auto calibration = read_tracker_recording(folder / "ReferenceToRASCalibration.igs.mha");
  EXPECT_EQ(calibration.frames.size(), 93u);
  EXPECT_THAT(calibration.sensor_names, ElementsAre("Reference", "Stylus"));
  EXPECT_EQ(count_missing(calibration), 0u);
  const auto landmarks = read_tracker_recording(folder / "EightLandmarkPointsTrackedForPhantomRegistration.igs.mha");
  EXPECT_EQ(landmarks.frames.size(), 1000u);
  EXPECT_EQ(count_missing(landmarks), 0u);
  for (const auto& frame : landmarks.frames) {
    for (const auto& reading : frame.readings) ASSERT_NEAR(reading.quaternion_wxyz.norm(), 1.0, 1e-12);
  }
  const auto interpolation = read_tracker_recording(folder / "TransformInterpolationTest.igs.mha");
  EXPECT_EQ(interpolation.frames.size(), 500u);
  EXPECT_THAT(interpolation.sensor_names, ElementsAre("Probe", "Reference"));
  EXPECT_EQ(count_missing(interpolation), 1u);
  EXPECT_EQ(interpolation.frames[7].readings[0].status, SensorReading::Status::kMissing);
  const auto filtering = read_tracker_recording(folder / "TimestampFilteringTest.igs.mha");
  EXPECT_EQ(filtering.frames.size(), 500u);
  EXPECT_THAT(filtering.sensor_names, ElementsAre("IdentityToIdentity"));
  EXPECT_EQ(filtering.frames[0].number, 5539);
  EXPECT_EQ(filtering.frames[0].time_s, 1840749.750288);
  EXPECT_THAT(filtering.notes, ElementsAre("frames_lost: 1343 by gaps in FrameNumber"));
}

}  // namespace
}  // namespace palpate
