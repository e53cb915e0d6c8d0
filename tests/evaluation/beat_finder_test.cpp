// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <palpate/evaluation/beat_finder.hpp>
#include <random>

namespace palpate {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// A beat as a raised cosine, breathing under it, noise over it; seconds 100 to 112, so many frames a second.
std::optional<BeatFinder::Beat> beat_of(double per_min, double beat_N, double breath_N, double noise_N,
                                        double rate_hz = 40.0, unsigned seed = 1) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> noise(0.0, noise_N);
  BeatFinder finder;
  for (int i = 0; i < 12 * rate_hz; ++i) {
    const double t = 100.0 + i / rate_hz;
    finder.add(t, 0.2 + 0.5 * beat_N * (1.0 - std::cos(kTurn * per_min / 60.0 * t)) +
                      breath_N * std::sin(kTurn * 0.25 * t) + (noise_N > 0.0 ? noise(engine) : 0.0));
  }
  return finder.find();
}

TEST(BeatFinder, FindsTheHeartUnderBreathingAndNoise) {
  for (const double rate_hz : {25.0, 40.0, 250.0})
    for (const double per_min : {45.0, 60.0, 72.0, 96.0, 130.0, 180.0}) {
      const auto beat = beat_of(per_min, 0.1, 0.05, 0.005, rate_hz);
      ASSERT_TRUE(beat) << per_min << " at " << rate_hz;
      EXPECT_NEAR(beat->per_min, per_min, 0.02 * per_min) << rate_hz;
      EXPECT_GT(beat->strength, 0.8);
    }
}

TEST(BeatFinder, NoiseAndBreathingBeatNot) {
  int found = 0;
  for (unsigned seed = 0; seed < 500; ++seed) found += beat_of(60.0, 0.0, 0.05, 0.005, 40.0, seed) ? 1 : 0;
  EXPECT_LE(found, 3);
  EXPECT_FALSE(beat_of(60.0, 0.0, 0.0, 0.0));
}

TEST(BeatFinder, OneBeatIsNotTakenForTwo) {
  // Sharp beats of 75 a minute: at two beats they are as alike as at one.
  BeatFinder finder;
  for (int i = 0; i < 480; ++i) {
    const double t = i / 40.0, phase = std::fmod(t, 0.8);
    finder.add(t, phase < 0.15 ? 0.3 : 0.1);
  }
  ASSERT_TRUE(finder.find());
  EXPECT_NEAR(finder.find()->per_min, 75.0, 1.0);
}

TEST(BeatFinder, NeedsHalfTheWindowAndForgetsTheRest) {
  BeatFinder finder;
  const auto beat = [](double t) { return 0.1 * std::cos(kTurn * 1.2 * t); };
  for (int i = 0; i < 160; ++i) finder.add(i / 40.0, beat(i / 40.0));
  EXPECT_FALSE(finder.find());
  for (int i = 160; i < 240; ++i) finder.add(i / 40.0, beat(i / 40.0));
  EXPECT_TRUE(finder.find());
  finder.add(3.0, 9.0);  // time that steps back is nothing
  EXPECT_TRUE(finder.find());
  finder.add(60.0, 0.1);
  EXPECT_FALSE(finder.find());
  finder.clear();
  EXPECT_FALSE(finder.find());
}

TEST(BeatFinder, ASlowTrackerIsToldNothingRatherThanSomethingWrong) {
  for (const double rate_hz : {5.0, 10.0, 13.0, 15.0, 16.0})
    for (const double per_min : {45.0, 72.0, 120.0, 150.0}) {
      const auto beat = beat_of(per_min, 0.1, 0.02, 0.002, rate_hz);
      EXPECT_NEAR(beat ? beat->per_min : per_min, per_min, 0.04 * per_min) << rate_hz;
    }
  for (const double per_min : {45.0, 72.0, 120.0, 150.0}) {
    ASSERT_TRUE(beat_of(per_min, 0.1, 0.02, 0.002, 20.0)) << per_min;
    EXPECT_NEAR(beat_of(per_min, 0.1, 0.02, 0.002, 20.0)->per_min, per_min, 0.03 * per_min);
  }
}

TEST(BeatFinder, AGapStaysOne) {
  BeatFinder finder;
  for (int i = 0; i < 480; ++i)
    if (const double t = i / 40.0; t < 5.0 || t > 6.3) finder.add(t, 0.1 * std::cos(kTurn * 1.2 * t));
  ASSERT_TRUE(finder.find());
  EXPECT_NEAR(finder.find()->per_min, 72.0, 1.5);
}

}  // namespace
}  // namespace palpate
