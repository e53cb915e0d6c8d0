// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>
#include <palpate/estimation/rhythm.hpp>
#include <tests/estimation/motions.hpp>

namespace palpate {
namespace {

using test::Draws;

constexpr double kPi = std::numbers::pi;

/// A wall that beats and breathes: harmonics of either, on top of a mean push; no contact for 2 s in every 10 s.
struct Wall {
  double heart_Hz, breathing_Hz;
  bool loses_contact = true;

  Vector3d force_N(double t_s) const {
    if (loses_contact && std::fmod(t_s, 10.0) > 8.0) return Vector3d::Zero();
    const double beat = 2.0 * kPi * heart_Hz * t_s, breath = 2.0 * kPi * breathing_Hz * t_s;
    const Vector3d heart = Vector3d(0.005, 0.02, -0.05) *
                           (std::cos(beat) + 0.4 * std::cos(2.0 * beat + 1.0) + 0.2 * std::cos(3.0 * beat + 2.0));
    const Vector3d breathing = Vector3d(0.04, 0.01, -0.03) * (std::cos(breath + 0.5) + 0.2 * std::cos(2.0 * breath));
    return Vector3d(0.01, 0.03, -0.1) + heart + breathing;
  }
};

/// Follows `force` for `seconds` as a filter would: its estimate has the error of the tip's noise.
template <class Force>
void listen(RhythmTracker& tracker, const Force& force, double seconds, double rate_Hz, unsigned seed) {
  Draws draws(seed);
  const Matrix3d R = test::tip_noise_N2();
  for (int k = 0; k < seconds * rate_Hz; ++k)
    tracker.observe(k == 0 ? 0.0 : 1.0 / rate_Hz, {force(k / rate_Hz) + Vector3d(test::draw(R, draws)), R});
}

/// 40 to 180 beats and 6 to 40 breaths a minute after 40 s, at 20 and 100 Hz. Tolerances: a quarter of the line's width
/// at half power, 0.045 Hz (memory 2.5 s) and 0.016 Hz (7 s): what parabola, noise and the other rhythm's lines can
/// shift.
TEST(RhythmTracker, FindsBothRatesOverTheWholeBand) {
  for (const double rate_Hz : {20.0, 100.0})
    for (const double beats : {40.0, 55.0, 72.0, 101.0, 140.0, 180.0})
      for (const double breaths : {6.0, 11.0, 15.0, 24.0, 40.0}) {
        if (breaths >= beats) continue;  // the same line
        const Wall wall{beats / 60.0, breaths / 60.0};
        RhythmTracker tracker;
        listen(
            tracker, [&](double t) { return wall.force_N(t); }, 48.0, rate_Hz, 91);
        EXPECT_TRUE(tracker.heart_locked()) << beats << ' ' << breaths;
        EXPECT_TRUE(tracker.breathing_locked()) << beats << ' ' << breaths;
        EXPECT_NEAR(tracker.rhythm().heart_Hz, wall.heart_Hz, 0.012) << beats << ' ' << breaths;
        EXPECT_NEAR(tracker.rhythm().breathing_Hz, wall.breathing_Hz, 0.006) << beats << ' ' << breaths;
      }
}

/// Amplitudes: 0.05 N of the heart on z has the spread 0.05 / sqrt(2) a quadrature; what leaks through breaks in
/// contact and through the level taken off (a high pass at 0.3 Hz) costs up to a fifth.
TEST(RhythmTracker, MeasuresTheHarmonics) {
  const Wall wall{1.2, 0.25, false};
  RhythmTracker tracker;
  listen(
      tracker, [&](double t) { return wall.force_N(t); }, 60.0, 40.0, 92);
  const Rhythm& found = tracker.rhythm();
  EXPECT_NEAR(found.heart_sigma_N[0].z() * std::numbers::sqrt2, 0.05, 0.01);
  EXPECT_NEAR(found.heart_sigma_N[1].z() * std::numbers::sqrt2, 0.02, 0.004);
  EXPECT_NEAR(found.heart_sigma_N[2].z() * std::numbers::sqrt2, 0.01, 0.002);
  EXPECT_NEAR(found.breathing_sigma_N[0].x() * std::numbers::sqrt2, 0.04, 0.008);
  EXPECT_NEAR(found.heart_sigma_N[0].x() * std::numbers::sqrt2, 0.005, 0.002);
}

/// Neither half nor twice the frequency of a pure tone.
TEST(RhythmTracker, TakesAPureToneForItsFundamental) {
  for (const double tone_Hz : {0.7, 1.4, 2.9}) {
    RhythmTracker tracker;
    listen(
        tracker, [&](double t) { return Vector3d(0.0, 0.1, 0.05 * std::cos(2.0 * kPi * tone_Hz * t)); }, 20.0, 40.0,
        93);
    EXPECT_TRUE(tracker.heart_locked());
    EXPECT_NEAR(tracker.rhythm().heart_Hz, tone_Hz, 0.012);
  }
}

/// From 60 to 90 beats a minute in 30 s: followed with the delay of the memory, 2 x 2.5 s x 1 beat/min per second.
TEST(RhythmTracker, FollowsAHeartThatSpeedsUp) {
  RhythmTracker tracker;
  const auto force = [](double t) {
    const double phase = 2.0 * kPi * (t + 0.5 * t * t / 60.0);  // f = 1 + t / 60
    return Vector3d(0.0, 0.02, 0.1 + 0.05 * std::cos(phase));
  };
  listen(tracker, force, 30.0, 40.0, 94);
  EXPECT_TRUE(tracker.heart_locked());
  EXPECT_NEAR(tracker.rhythm().heart_Hz, 1.5, 0.12);
}

TEST(RhythmTracker, HearsNothingWhereNothingBeats) {
  RhythmTracker constant, absent, slow;
  listen(
      constant, [](double) { return Vector3d(0.0, 0.1, 0.1); }, 60.0, 40.0, 95);
  listen(
      absent, [](double) { return Vector3d(Vector3d::Zero()); }, 60.0, 40.0, 96);
  listen(
      slow, [](double t) { return Vector3d(0.0, 0.1, 0.003 * t); }, 60.0, 40.0, 97);
  for (const RhythmTracker* tracker : {&constant, &absent, &slow}) {
    EXPECT_FALSE(tracker->heart_locked());
    EXPECT_FALSE(tracker->breathing_locked());
    EXPECT_EQ(tracker->rhythm().heart_sigma_N[0].norm(), 0.0);
  }
}

/// The force is lost for good: the lock is given up and the amplitudes with it; a NaN in between does no harm.
TEST(RhythmTracker, LetsGoWhenTheBeatIsGone) {
  const Wall wall{1.2, 0.25, false};
  RhythmTracker tracker;
  listen(
      tracker, [&](double t) { return wall.force_N(t); }, 30.0, 40.0, 98);
  ASSERT_TRUE(tracker.heart_locked());
  tracker.observe(0.025, {Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()), Matrix3d::Identity()});
  listen(
      tracker, [](double) { return Vector3d(Vector3d::Zero()); }, 60.0, 40.0, 99);
  EXPECT_FALSE(tracker.heart_locked());
  EXPECT_TRUE(std::isfinite(tracker.rhythm().heart_Hz));
}

}  // namespace
}  // namespace palpate
