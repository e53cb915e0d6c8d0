// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/plot/thinning.hpp>

namespace palpate::plot {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr PixelAxis kMinute{.from = 0.0, .to = 60.0, .pixels = 500};
constexpr PixelAxis kAnyHeight{};

std::vector<double> minute(std::size_t count) {
  std::vector<double> x(count);
  for (std::size_t i = 0; i < count; ++i) x[i] = 60.0 * static_cast<double>(i) / static_cast<double>(count);
  return x;
}

TEST(ThinLine, KeepsASingleSamplePeakAmong24000) {
  const std::vector<double> x = minute(24000);
  std::vector<double> y(x.size(), 0.0);
  y[12345] = 5.0;
  y[777] = -3.0;
  const auto runs = thin_line(x, y, kMinute, kAnyHeight);
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_LE(runs[0].size(), 4U * 500U);
  const auto by_y = [](const Point& a, const Point& b) { return a.y < b.y; };
  const auto [low, high] = std::minmax_element(runs[0].begin(), runs[0].end(), by_y);
  EXPECT_EQ(high->y, 5.0);
  EXPECT_EQ(high->x, x[12345]);
  EXPECT_EQ(low->y, -3.0);
  EXPECT_EQ(low->x, x[777]);
}

TEST(ThinLine, KeepsOrderAndEnds) {
  const std::vector<double> x = minute(5000);
  std::vector<double> y(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = std::sin(37.0 * x[i]);
  const auto runs = thin_line(x, y, kMinute, kAnyHeight);
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_EQ(runs[0].front().x, x.front());
  EXPECT_EQ(runs[0].back().x, x.back());
  EXPECT_TRUE(std::is_sorted(runs[0].begin(), runs[0].end(), [](const Point& a, const Point& b) { return a.x < b.x; }));
}

TEST(ThinLine, LeavesFewPointsAlone) {
  const auto runs = thin_line({0.0, 20.0, 10.0}, {1.0, 2.0, 3.0}, kMinute, kAnyHeight);
  ASSERT_EQ(runs.size(), 1U);
  ASSERT_EQ(runs[0].size(), 3U);
  EXPECT_EQ(runs[0][1].x, 20.0);
  EXPECT_EQ(runs[0][2].x, 10.0);
}

TEST(ThinLine, EndsARunAtEveryGapEvenInsideOnePixel) {
  const auto runs = thin_line({0.0, 0.001, 0.002, kNaN, 0.004}, {1.0, kNaN, 2.0, 3.0, 4.0}, kMinute, kAnyHeight);
  ASSERT_EQ(runs.size(), 3U);
  EXPECT_EQ(runs[0][0].y, 1.0);
  EXPECT_EQ(runs[1][0].y, 2.0);
  EXPECT_EQ(runs[2][0].y, 4.0);
}

TEST(ThinLine, TakesWhatALogarithmicAxisCannotShowAsGap) {
  const PixelAxis log{.from = 0.1, .to = 10.0, .log = true, .pixels = 100};
  EXPECT_EQ(thin_line({1.0, 2.0, 3.0}, {1.0, 0.0, 1.0}, kMinute, log).size(), 2U);
  EXPECT_EQ(thin_line({1.0, -2.0, 3.0}, {1.0, 1.0, 1.0}, log, kAnyHeight).size(), 2U);
}

TEST(ThinBand, IsTheEnvelope) {
  const std::vector<double> x = minute(24000);
  std::vector<double> lower(x.size(), -1.0), upper(x.size(), 1.0);
  lower[5000] = -7.0;
  upper[6000] = 8.0;
  const auto runs = thin_band(x, lower, upper, kMinute, kAnyHeight);
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_LE(runs[0].size(), 2U * 500U);
  double least = 0.0, greatest = 0.0;
  for (const BandPoint& p : runs[0]) {
    least = std::min(least, p.lower);
    greatest = std::max(greatest, p.upper);
  }
  EXPECT_EQ(least, -7.0);
  EXPECT_EQ(greatest, 8.0);
  EXPECT_EQ(runs[0].back().x, x.back());
}

TEST(ThinBand, GapsWhereEitherEdgeIsMissing) {
  EXPECT_EQ(
      thin_band({0.0, 1.0, 2.0, 3.0, 4.0}, {0.0, kNaN, 0.0, 0.0, 0.0}, {1.0, 1.0, 1.0, kNaN, 1.0}, kMinute, kAnyHeight)
          .size(),
      3U);
}

TEST(ThinCloud, KeepsOnePointAPixel) {
  const PixelAxis unit{.pixels = 10};
  const auto kept = thin_cloud({0.11, 0.12, 0.11, 0.95, kNaN}, {0.51, 0.52, 0.91, 0.51, 0.1}, unit, unit);
  EXPECT_EQ(kept.size(), 3U);
}

TEST(PixelAxis, CountsDecadesEvenlyWhenLogarithmic) {
  const PixelAxis log{.from = 1.0, .to = 100.0, .log = true, .pixels = 100};
  EXPECT_EQ(log.pixel(9.999), 49);
  EXPECT_EQ(log.pixel(10.001), 50);
}

}  // namespace
}  // namespace palpate::plot
