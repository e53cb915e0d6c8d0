// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <boost/math/distributions/chi_squared.hpp>
#include <palpate/service/consistency_alarm.hpp>
#include <random>

namespace palpate::service {
namespace {

Estimate frame_with(double nis, int dof = 12, EstimateStatus status = EstimateStatus::kUpdated) {
  Estimate out;
  out.status = status;
  out.time = FrameTime::kAdvanced;
  out.nis = nis;
  out.dof = dof;
  return out;
}

TEST(ConsistencyAlarm, IsSilentWhereTheNoiseIsAsClaimed) {
  std::mt19937_64 random(7);
  std::chi_squared_distribution<double> chi_square(12.0);
  ConsistencyAlarm alarm;
  int alarms = 0;
  for (int i = 0; i < 100'000; ++i) {
    alarm.take(frame_with(chi_square(random)));
    alarms += alarm.alarmed() ? 1 : 0;
  }
  EXPECT_LE(alarms, 20);  // 0.1 windows expected; one lasts ten frames
}

TEST(ConsistencyAlarm, ItsBoundIsTheQuantileOfBoost) {
  const double bound = quantile(complement(boost::math::chi_squared(120), 1e-6));
  for (const double share : {0.99, 1.01}) {
    ConsistencyAlarm alarm;
    for (int i = 0; i < 10; ++i) alarm.take(frame_with(share * bound / 10.0));
    EXPECT_EQ(alarm.alarmed(), share > 1.0);
  }
}

TEST(ConsistencyAlarm, RisesWithinTenFramesOfABiasAndFallsAfterIt) {
  ConsistencyAlarm alarm;
  for (int i = 0; i < 50; ++i) alarm.take(frame_with(12.0));
  int frames = 0;
  while (!alarm.alarmed() && frames < 100) {
    alarm.take(frame_with(36.0));
    ++frames;
  }
  EXPECT_LE(frames, 10);
  for (int i = 0; i < 10; ++i) alarm.take(frame_with(12.0));
  EXPECT_FALSE(alarm.alarmed());
}

TEST(ConsistencyAlarm, RefusedFramesCountAndSilenceDoesNot) {
  ConsistencyAlarm alarm;
  for (int i = 0; i < 4; ++i) alarm.take(frame_with(0.0, 0, EstimateStatus::kRejected));
  EXPECT_TRUE(alarm.alarmed());
  ConsistencyAlarm silent;
  for (int i = 0; i < 20; ++i) silent.take(frame_with(0.0, 0, EstimateStatus::kHeld));
  EXPECT_FALSE(silent.alarmed());
}

TEST(ConsistencyAlarm, ABadClockSaysNothingOfTheShape) {
  ConsistencyAlarm alarm;
  Estimate back = frame_with(0.0, 0, EstimateStatus::kRejected);
  back.time = FrameTime::kStepsBack;
  for (int i = 0; i < 20; ++i) alarm.take(back);
  EXPECT_FALSE(alarm.alarmed());
}

}  // namespace
}  // namespace palpate::service
