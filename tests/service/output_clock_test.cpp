// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <palpate/service/output_clock.hpp>
#include <vector>

namespace palpate::service {
namespace {

constexpr double kUtc_s = 1.8e9;

/// Output times of frames 25 ms apart on the host's clock whose device says so.
std::vector<double> stamps(const std::vector<double>& device_s) {
  OutputClock clock;
  std::vector<double> out;
  for (std::size_t i = 0; i < device_s.size(); ++i)
    out.push_back(clock.stamp(device_s[i], kUtc_s + 0.025 * static_cast<double>(i)));
  return out;
}

void expect_monotonic(const std::vector<double>& out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    EXPECT_TRUE(std::isfinite(out[i])) << i;
    EXPECT_GE(out[i], out[i == 0 ? 0 : i - 1]) << i;
  }
}

TEST(OutputClock, ADeviceThatKeepsUtcIsBelieved) {
  const std::vector<double> device{kUtc_s - 0.01, kUtc_s + 0.015, kUtc_s + 0.04};
  EXPECT_EQ(stamps(device), device);
}

/// Frames that waited a second for the observer, silence said between each two of them: time does not run away.
TEST(OutputClock, FramesThatWaitedAreNotCountedTwice) {
  OutputClock clock;
  double last_s = clock.stamp(100.0, kUtc_s);
  for (int i = 1; i <= 40; ++i) {
    const double now_s = kUtc_s + 1.0 + 1e-4 * i;
    clock.stamp(std::numeric_limits<double>::quiet_NaN(), now_s);
    last_s = clock.stamp(100.0 + 0.025 * i, kUtc_s + 0.025 * i);
  }
  EXPECT_LT(last_s, kUtc_s + 1.1);
}

TEST(OutputClock, AnotherClockIsMovedToUtcOnce) {
  const std::vector<double> out = stamps({100.0, 100.025, 100.05});
  EXPECT_EQ(out[0], kUtc_s);
  EXPECT_NEAR(out[2] - out[0], 0.05, 1e-6);  // doubles near 1.8e9 are 2.4e-7 apart
}

TEST(OutputClock, AJumpOfAnHourIsCarriedByTheHostsClock) {
  for (const double jump_s : {3600.0, -3600.0}) {
    std::vector<double> device;
    for (int i = 0; i < 40; ++i) device.push_back(kUtc_s + 0.025 * i + (i >= 20 ? jump_s : 0.0));
    const std::vector<double> out = stamps(device);
    expect_monotonic(out);
    EXPECT_NEAR(out.back() - out.front(), 39 * 0.025, 1e-6) << jump_s;
  }
}

TEST(OutputClock, AStallDoesNotMoveAClockThatKeepsUtc) {
  OutputClock clock;
  for (int i = 0; i < 40; ++i) clock.stamp(kUtc_s + 0.025 * i, kUtc_s + 0.025 * i);
  for (int i = 40; i < 160; ++i) EXPECT_EQ(clock.stamp(kUtc_s + 0.025 * i, kUtc_s + 4.0), kUtc_s + 0.025 * i);
}

TEST(OutputClock, StandingStillSteppingBackAndNanNeverRunBack) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_monotonic(stamps({5.0, 5.0, 5.0, 4.9, 5.1, nan, 5.2, 1e300, -1e300, 5.3}));
  expect_monotonic(stamps({nan, nan, 3.0, 3.025}));
}

}  // namespace
}  // namespace palpate::service
