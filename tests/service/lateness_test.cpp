// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <palpate/service/lateness.hpp>

namespace palpate::service {
namespace {

constexpr double kUtc_s = 1.8e9;

TEST(Lateness, TheFastestFrameIsFresh) {
  Lateness lateness;
  EXPECT_EQ(lateness.late_s(0.0, kUtc_s + 0.030), 0.0);
  EXPECT_EQ(lateness.late_s(0.1, kUtc_s + 0.110), 0.0);
  EXPECT_NEAR(lateness.late_s(0.2, kUtc_s + 0.230), 0.020, 1e-4);
}

TEST(Lateness, ABurstAfterAStallIsOldAndThenFresh) {
  Lateness lateness;
  for (int i = 0; i < 10; ++i) lateness.late_s(0.1 * i, kUtc_s + 0.1 * i);
  for (int i = 10; i < 20; ++i) EXPECT_NEAR(lateness.late_s(0.1 * i, kUtc_s + 2.0), 2.0 - 0.1 * i, 1e-3);
  EXPECT_NEAR(lateness.late_s(2.0, kUtc_s + 2.0), 0.0, 1e-3);
}

TEST(Lateness, ClocksThatDriftApartMakeNoFrameOld) {
  Lateness lateness;
  double worst_s = 0.0;
  for (int i = 0; i < 36'000; ++i)
    worst_s = std::max(worst_s, lateness.late_s(0.1 * i, kUtc_s + 0.1 * i * (1.0 + 5e-5)));
  EXPECT_LT(worst_s, 4e-3);
}

TEST(Lateness, AClockThatWasSetIsBelievedAfterAMinute) {
  Lateness lateness;
  for (int i = 0; i < 100; ++i) lateness.late_s(5000.0 + i, kUtc_s + i);
  EXPECT_NEAR(lateness.late_s(5080.0, kUtc_s + 100.0), 20.0, 1e-6);
  for (int i = 101; i < 162; ++i) lateness.late_s(4980.0 + i, kUtc_s + i);
  EXPECT_NEAR(lateness.late_s(5142.0, kUtc_s + 162.0), 0.0, 1e-6);
}

TEST(Lateness, BeginsAnewWhereToldTo) {
  Lateness lateness;
  lateness.late_s(5000.0, kUtc_s);
  lateness.begin_anew();
  EXPECT_EQ(lateness.late_s(0.0, kUtc_s + 0.1), 0.0);
  EXPECT_EQ(lateness.late_s(std::numeric_limits<double>::quiet_NaN(), kUtc_s), 0.0);
}

}  // namespace
}  // namespace palpate::service
