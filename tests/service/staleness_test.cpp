// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/service/staleness.hpp>

namespace palpate::service {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

Staleness after_frames(std::int64_t period_ns, int count) {
  Staleness out;
  for (int i = 1; i <= count; ++i) out.frame(i * period_ns, period_ns);
  return out;
}

TEST(Staleness, WaitsForThreePeriodsOrATenthOfASecond) {
  EXPECT_EQ(after_frames(25 * kMillisecond, 20).limit_ns(), 100 * kMillisecond);
  EXPECT_EQ(after_frames(1 * kMillisecond, 20).limit_ns(), 100 * kMillisecond);
  EXPECT_EQ(after_frames(200 * kMillisecond, 20).limit_ns(), 600 * kMillisecond);
}

TEST(Staleness, OneGapDoesNotChangeThePeriod) {
  Staleness staleness = after_frames(50 * kMillisecond, 20);
  staleness.frame(20 * 50 * kMillisecond + 5'000 * kMillisecond, 5'000 * kMillisecond);
  EXPECT_EQ(staleness.period_ns(), 50 * kMillisecond);
}

TEST(Staleness, TwoFramesFarApartDoNotMakeItPatient) {
  Staleness staleness;
  staleness.frame(1, 0);
  staleness.frame(1 + 3'600'000 * kMillisecond, 3'600'000 * kMillisecond);
  EXPECT_LE(staleness.limit_ns(), Staleness::kMost_ns);
}

TEST(Staleness, BurstsDoNotMakeItImpatient) {
  Staleness staleness;
  for (int i = 1; i <= 60; ++i) staleness.frame((i / 10) * 1'000 * kMillisecond + i, 100 * kMillisecond);
  EXPECT_EQ(staleness.limit_ns(), 300 * kMillisecond);
}

TEST(Staleness, NothingIsStaleBeforeTheFirstFrame) {
  Staleness staleness;
  EXPECT_FALSE(staleness.started());
  EXPECT_FALSE(staleness.stale());
}

TEST(Staleness, IsOverWithTheNextFrame) {
  Staleness staleness = after_frames(25 * kMillisecond, 5);
  staleness.say_stale();
  EXPECT_TRUE(staleness.stale());
  staleness.frame(1'000 * kMillisecond, kMillisecond);
  EXPECT_FALSE(staleness.stale());
}

}  // namespace
}  // namespace palpate::service
