// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <tests/observer/runs.hpp>

/// What faults of the tracker do to the state: nothing that a missing reading would not do.
namespace palpate {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

class BadFrames : public ::testing::TestWithParam<Method> {
 protected:
  using Change = std::function<void(TrackerFrame&)>;

  /// Runs one second, one changed frame, and 5 frames more; the estimates from the changed frame on.
  std::vector<Estimate> after(const Change& change) const {
    std::vector<TrackerFrame> frames = recording_.frames;
    change(frames[kChanged]);
    std::vector<Estimate> all = test::run(catheter_, options_, frames);
    return {all.begin() + kChanged, all.end()};
  }

  static Change missing(std::size_t sensor) {
    return [=](TrackerFrame& frame) { frame.readings[sensor] = SensorReading{}; };
  }
  static Change reading(std::size_t sensor, const std::function<void(SensorReading&)>& change) {
    return [=](TrackerFrame& frame) { change(frame.readings[sensor]); };
  }

  static constexpr int kChanged = 40;
  ObserverOptions options_{.method = GetParam()};
  Catheter catheter_ = test::two_sensors();
  VirtualRecording recording_ = simulate_tracker(catheter_, beating_wall_force, {.duration_s = 1.15});
};

TEST_P(BadFrames, ABadReadingLeavesWhatAMissingOneLeaves) {
  const std::pair<Rejection, std::function<void(SensorReading&)>> faults[] = {
      {Rejection::kNotFinite, [](SensorReading& r) { r.position_m.z() = kNaN; }},
      {Rejection::kNotFinite, [](SensorReading& r) { r.quaternion_wxyz(2) = kInf; }},
      {Rejection::kZeroQuaternion, [](SensorReading& r) { r.quaternion_wxyz.setZero(); }},
      {Rejection::kNonUnitQuaternion, [](SensorReading& r) { r.quaternion_wxyz *= 1.02; }},
      {Rejection::kIdentityPose,
       [](SensorReading& r) {
         r.quaternion_wxyz = {1, 0, 0, 0};
         r.position_m.setZero();
       }},
      {Rejection::kNoOrientation, [](SensorReading& r) { r.has_orientation = false; }},
  };
  for (const std::size_t sensor : {0U, 1U}) {
    const std::vector<Estimate> expected = after(missing(sensor));
    EXPECT_EQ(expected[0].rejections[sensor], Rejection::kMissing);
    EXPECT_EQ(expected[0].sensors_used, 1);
    for (const auto& [rejection, fault] : faults) {
      const std::vector<Estimate> found = after(reading(sensor, fault));
      EXPECT_EQ(found[0].rejections[sensor], rejection);
      for (std::size_t i = 0; i < found.size(); ++i) EXPECT_TRUE(test::same_state(found[i], expected[i]));
    }
  }
}

TEST_P(BadFrames, AnOutlierOf25MillimetresLeavesWhatAMissingReadingLeaves) {
  for (const std::size_t sensor : {0U, 1U})
    for (const Vector3d& direction : {Vector3d(1, 0, 0), Vector3d(0, -1, 0), Vector3d(0.6, 0, -0.8)}) {
      const std::vector<Estimate> expected = after(missing(sensor));
      const std::vector<Estimate> found =
          after(reading(sensor, [&](SensorReading& r) { r.position_m += 25e-3 * direction; }));
      EXPECT_EQ(found[0].status, EstimateStatus::kUpdated);
      EXPECT_EQ(found[0].rejections[sensor], Rejection::kOutlier);
      EXPECT_EQ(found[0].rejections[1 - sensor], Rejection::kNone);
      EXPECT_EQ(found[0].used, 1U << (1 - sensor));
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_LT((found[i].force_tip_N - expected[i].force_tip_N).norm(), 1e-6);
        EXPECT_LT((found[i].covariance_tip_N2 - expected[i].covariance_tip_N2).norm(), 1e-6);
      }
    }
}

TEST_P(BadFrames, WithoutUsableSensorsTheMeanIsHeldAndTheCovarianceGrowsByTheRandomWalk) {
  options_.force_model = ForceMotion::kRandomWalk;
  options_.force_rate_N_per_sqrt_s = 0.2;
  std::vector<TrackerFrame> frames = recording_.frames;
  for (SensorReading& r : frames[kChanged].readings) r = SensorReading{};
  frames[kChanged].time_s = frames[kChanged - 1].time_s + 0.125;
  frames.resize(kChanged + 1);
  const std::vector<Estimate> all = test::run(catheter_, options_, frames);
  const Estimate &before = all[kChanged - 1], &held = all[kChanged];
  EXPECT_EQ(held.status, EstimateStatus::kHeld);
  EXPECT_EQ(held.used, 0U);
  EXPECT_EQ(held.dof, 0);
  EXPECT_LT((held.force_tip_N - before.force_tip_N).norm(), 1e-12);
  EXPECT_LT((held.force_base_N - before.force_base_N).norm(), 1e-12);
  const double q = options_.force_rate_N_per_sqrt_s, dt_s = frames[kChanged].time_s - frames[kChanged - 1].time_s;
  const Matrix3d grown = before.covariance_tip_N2 + Matrix3d(Vector3d::Constant(q * q * dt_s).asDiagonal());
  EXPECT_LT((held.covariance_tip_N2 - grown).norm(), 1e-12);
}

/// Nothing has been seen, so nothing is observable; the first good frame says what is.
TEST_P(BadFrames, BeforeTheFirstUsableFrameNothingIsObservable) {
  ForceObserver observer(catheter_, options_);
  TrackerFrame blind = recording_.frames[0];
  for (SensorReading& r : blind.readings) r = SensorReading{};
  const Observability nothing = observer.update(blind).observability;
  EXPECT_FALSE(nothing.all_observable());
  EXPECT_TRUE(nothing.axial_force_hidden && nothing.lateral_force_hidden);
  EXPECT_EQ(nothing.weakest_sigmas, kInf);
  const Observability seen = observer.update(recording_.frames[1]).observability;
  EXPECT_FALSE(seen.lateral_force_hidden);
  EXPECT_LT(seen.weakest_sigmas, 10.0);
}

TEST_P(BadFrames, ImpossibleTimesAreRejectedAndTheStateStaysBitForBit) {
  const double last_s = recording_.frames[kChanged - 1].time_s;
  const std::pair<FrameTime, double> times[] = {{FrameTime::kStandsStill, last_s},
                                                {FrameTime::kStepsBack, last_s - 0.01},
                                                {FrameTime::kNotFinite, kNaN},
                                                {FrameTime::kNotFinite, kInf}};
  std::vector<TrackerFrame> without = recording_.frames;
  without.erase(without.begin() + kChanged);
  const std::vector<Estimate> expected = test::run(catheter_, options_, without);
  for (const auto& [verdict, time_s] : times) {
    const std::vector<Estimate> found = after([stamp_s = time_s](TrackerFrame& frame) { frame.time_s = stamp_s; });
    EXPECT_EQ(found[0].status, EstimateStatus::kRejected);
    EXPECT_EQ(found[0].time, verdict);
    EXPECT_EQ(found[0].used, 0U);
    EXPECT_EQ(found[0].evaluations, 0);
    for (std::size_t i = 0; i < found.size(); ++i)
      EXPECT_TRUE(test::same_state(found[i], expected[kChanged - 1 + i])) << "frame " << i;
  }
}

TEST_P(BadFrames, TwoSensorsThatContradictEachOtherAreRejectedOrOneOfThemIsDropped) {
  const std::vector<Estimate> found = after([](TrackerFrame& frame) {
    frame.readings[0].position_m.x() += 0.2;
    frame.readings[1].position_m.y() -= 0.2;
  });
  EXPECT_TRUE(found[0].status == EstimateStatus::kRejected || found[0].status == EstimateStatus::kNotConverged);
  EXPECT_EQ(found[0].used, 0U);
  EXPECT_EQ(found[1].status, EstimateStatus::kUpdated) << "and the next good frame is taken";
}

TEST_P(BadFrames, LostBaseSensorHoldsTheEstimate) {
  catheter_ = test::with_tracked_base(catheter_);
  recording_ = simulate_tracker(catheter_, beating_wall_force, {.duration_s = 1.15});
  const std::vector<Estimate> found = after(missing(2));
  EXPECT_EQ(found[0].status, EstimateStatus::kHeld);
  EXPECT_EQ(found[0].rejections[2], Rejection::kMissing);
  EXPECT_EQ(found[1].status, EstimateStatus::kUpdated);
}

/// 1 % gross outliers, 4 % missing: no frame with a usable reading is lost, and sigma stays true.
TEST_P(BadFrames, FaultyRecordingIsFollowed) {
  const auto recording = simulate_tracker(
      catheter_, beating_wall_force, {.duration_s = 20.0, .seed = 9, .missing_share = 0.04, .outlier_share = 0.01});
  const std::vector<Estimate> estimates = test::run(catheter_, options_, recording.frames);
  std::size_t outliers = 0;
  for (const Estimate& e : estimates)
    for (const Rejection r : e.rejections) outliers += r == Rejection::kOutlier ? 1 : 0;
  EXPECT_GE(outliers, 8U);  // 1600 readings: 16 +- 4
  EXPECT_GE(test::share_within(4.0, estimates, recording), 0.99);
}

INSTANTIATE_TEST_SUITE_P(Method, BadFrames, ::testing::ValuesIn(test::kEveryMethod),
                         [](const auto& test_case) { return std::string(test::name_of(test_case.param)); });

}  // namespace
}  // namespace palpate
