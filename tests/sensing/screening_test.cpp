// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <palpate/sensing/screening.hpp>

namespace palpate {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

SensorReading good() {
  SensorReading reading;
  reading.status = SensorReading::Status::kOk;
  reading.has_orientation = true;
  reading.quaternion_wxyz = {0.5, -0.5, 0.5, 0.5};
  reading.position_m = {0.01, -0.02, 0.3};
  return reading;
}

template <typename Change>
Rejection after(const Change& change, SensorKind kind = SensorKind::kPose) {
  SensorReading reading = good();
  change(reading);
  return screen(reading, kind);
}

TEST(Screening, GoodReadingPassesForEveryKind) {
  for (const SensorKind kind : {SensorKind::kPose, SensorKind::kPose5, SensorKind::kPosition})
    EXPECT_EQ(screen(good(), kind), Rejection::kNone);
}

TEST(Screening, MissingComesBeforeEverythingElse) {
  EXPECT_EQ(screen(SensorReading{}, SensorKind::kPose), Rejection::kMissing);
  EXPECT_EQ(after([](SensorReading& r) { r.status = SensorReading::Status::kMissing; }), Rejection::kMissing);
}

TEST(Screening, AbsentIsNotMissing) {
  EXPECT_EQ(screen({.status = SensorReading::Status::kAbsent}, SensorKind::kPose), Rejection::kAbsent);
  EXPECT_EQ(after([](SensorReading& r) { r.status = SensorReading::Status::kAbsent; }), Rejection::kAbsent);
  EXPECT_EQ(describe(Rejection::kAbsent), "not in the frame");
}

TEST(Screening, NumbersThatAreNotFinite) {
  for (const double bad : {kNaN, kInf, -kInf}) {
    for (int i = 0; i < 3; ++i)
      EXPECT_EQ(after([&](SensorReading& r) { r.position_m(i) = bad; }), Rejection::kNotFinite);
    for (int i = 0; i < 4; ++i)
      EXPECT_EQ(after([&](SensorReading& r) { r.quaternion_wxyz(i) = bad; }), Rejection::kNotFinite);
  }
}

TEST(Screening, PositionOfAPointSensorMustBeFiniteToo) {
  const auto point = [](SensorReading& r) {
    r.has_orientation = false;
    r.position_m.y() = kNaN;
  };
  EXPECT_EQ(after(point, SensorKind::kPosition), Rejection::kNotFinite);
}

TEST(Screening, ZeroQuaternion) {
  EXPECT_EQ(after([](SensorReading& r) { r.quaternion_wxyz.setZero(); }), Rejection::kZeroQuaternion);
}

TEST(Screening, QuaternionNormMayBeOffByOnePercent) {
  EXPECT_EQ(after([](SensorReading& r) { r.quaternion_wxyz *= 1.02; }), Rejection::kNonUnitQuaternion);
  EXPECT_EQ(after([](SensorReading& r) { r.quaternion_wxyz *= 0.98; }), Rejection::kNonUnitQuaternion);
  EXPECT_EQ(after([](SensorReading& r) { r.quaternion_wxyz *= 1.009; }), Rejection::kNone);
  EXPECT_EQ(after([](SensorReading& r) { r.quaternion_wxyz *= 0.991; }), Rejection::kNone);
}

TEST(Screening, ExactIdentityIsAFaultOfEitherSign) {
  for (const double sign : {1.0, -1.0}) {
    const auto identity = [&](SensorReading& r) {
      r.quaternion_wxyz = {sign, 0.0, -0.0, 0.0};
      r.position_m.setZero();
    };
    EXPECT_EQ(after(identity), Rejection::kIdentityPose);
    EXPECT_EQ(after(identity, SensorKind::kPose5), Rejection::kIdentityPose);
  }
}

TEST(Screening, NearlyIdentityIsAPose) {
  EXPECT_EQ(after([](SensorReading& r) { r.quaternion_wxyz = {1, 0, 0, 0}; }), Rejection::kNone);
  EXPECT_EQ(after([](SensorReading& r) { r.position_m.setZero(); }), Rejection::kNone);
  const auto nearly = [](SensorReading& r) {
    r.quaternion_wxyz = {1, 0, 0, 0};
    r.position_m = {1e-9, 0, 0};
  };
  EXPECT_EQ(after(nearly), Rejection::kNone);
}

TEST(Screening, APointIsEnoughForAPositionSensorOnly) {
  const auto point = [](SensorReading& r) {
    r.has_orientation = false;
    r.quaternion_wxyz.setZero();
  };
  EXPECT_EQ(after(point, SensorKind::kPosition), Rejection::kNone);
  EXPECT_EQ(after(point, SensorKind::kPose), Rejection::kNoOrientation);
  EXPECT_EQ(after(point, SensorKind::kPose5), Rejection::kNoOrientation);
}

TEST(Screening, EveryReasonHasItsWord) {
  EXPECT_EQ(describe(Rejection::kNone), "none");
  EXPECT_EQ(describe(Rejection::kMissing), "missing");
  EXPECT_EQ(describe(Rejection::kNotFinite), "not finite");
  EXPECT_EQ(describe(Rejection::kZeroQuaternion), "zero quaternion");
  EXPECT_EQ(describe(Rejection::kNonUnitQuaternion), "non-unit quaternion");
  EXPECT_EQ(describe(Rejection::kIdentityPose), "identity pose");
  EXPECT_EQ(describe(Rejection::kNoOrientation), "no orientation");
  EXPECT_EQ(describe(Rejection::kOutlier), "outlier");
}

/// Devices write zeros for the orientation of a tool that has none.
TEST(Screening, APositionSensorNeedsNoQuaternion) {
  SensorReading reading;
  reading.status = SensorReading::Status::kOk;
  reading.has_orientation = true;
  reading.position_m = {0.1, 0.2, 0.3};
  EXPECT_EQ(screen(reading, SensorKind::kPosition), Rejection::kNone);
  EXPECT_EQ(screen(reading, SensorKind::kPose), Rejection::kZeroQuaternion);
}

}  // namespace
}  // namespace palpate
