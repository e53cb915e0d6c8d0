// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <palpate/identification/delay.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/observer/smoothing.hpp>
#include <tests/random_draws.hpp>
#include <tests/shared_recordings.hpp>

namespace palpate {
namespace {

using test::Draws;
using ::testing::HasSubstr;

/// A force known at every time, felt by a tracker and by a force sensor whose clocks differ.
struct VirtualPair {
  double delay_s = 0.037;
  double gain = 1.06;
  Vector3d offset_N{0.01, -0.02, 0.03};
  double noise_N = 8e-3;  ///< of the tracker's force, per axis, at one time
  double memory = 0.0;    ///< share of the noise that stays to the next frame
  double jitter_s = 0.008, dropout = 0.1;
  bool periodic = false;

  Vector3d force(double t) const {
    constexpr double kTurn = 2.0 * std::numbers::pi;
    const double beat = std::sin(kTurn * 1.2 * t) + 0.4 * std::sin(kTurn * 2.4 * t + 0.7);
    const double breath =
        periodic ? 0.0 : std::sin(kTurn * 0.27 * t) + 0.5 * std::sin(kTurn * 0.11 * t * (1 + 0.02 * t));
    return {0.05 * beat + 0.03 * breath, 0.02 * beat - 0.02 * breath, -0.08 * beat + 0.02 * breath};
  }

  std::vector<TimedForce> sensor(double from_s = 0.0, double to_s = 20.0, double rate_Hz = 70.0) const {
    std::vector<TimedForce> trace;
    for (double t = from_s; t < to_s; t += 1.0 / rate_Hz) trace.push_back({t, force(t)});
    return trace;
  }

  std::vector<TimedForce> tracker(unsigned seed, double duration_s = 20.0) const {
    Draws draws(seed);
    std::vector<TimedForce> felt;
    Vector3d noise = noise_N * draws.normal3();
    for (double t = 0.02; t < duration_s; t += 0.025) {
      noise = memory * noise + std::sqrt(1.0 - memory * memory) * noise_N * draws.normal3();
      if (draws.uniform(0.0, 1.0) < dropout) continue;
      const double event_s = t + draws.uniform(-0.5, 0.5) * jitter_s;
      felt.push_back({event_s + delay_s, gain * force(event_s) + offset_N + noise, Vector3d::Constant(noise_N)});
    }
    return felt;
  }
};

/// Over seeds: right, and off by as much as the sigma says.
void expect_honest(const VirtualPair& pair) {
  double squares = 0.0;
  int inside = 0;
  constexpr int kSeeds = 60;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const DelayFit fit = identify_delay(pair.tracker(seed), pair.sensor());
    const double sigmas = (fit.delay_s - pair.delay_s) / fit.sigma_s;
    EXPECT_LT(std::abs(sigmas), 4.5) << fit.delay_s << " +- " << fit.sigma_s << " seed " << seed;
    squares += sigmas * sigmas / kSeeds;
    inside += std::abs(sigmas) < 1.96 ? 1 : 0;
    EXPECT_NEAR(fit.gain, pair.gain, 5.0 * fit.gain_sigma);
    EXPECT_LT(fit.sigma_s, 5e-3);
  }
  // Chi-square with 60 degrees of freedom over 60: 0.6 to 1.5 with 99.8 %.
  EXPECT_GT(squares, 0.6);
  EXPECT_LT(squares, 1.6);
  EXPECT_GE(inside, 51);
}

TEST(Delay, JitterDropoutsGainAndOffset) { expect_honest({}); }
TEST(Delay, CorrelatedNoise) { expect_honest({.delay_s = -0.12, .memory = 0.85}); }

TEST(Delay, AnyDelayWithoutNoise) {
  for (const double delay_s : {-0.12, -0.0123, 0.0, 0.0071, 0.037, 0.3}) {
    const VirtualPair pair{.delay_s = delay_s, .noise_N = 0.0};
    auto felt = pair.tracker(1);
    for (TimedForce& sample : felt) sample.sigma_N.setOnes();
    const DelayFit fit = identify_delay(felt, pair.sensor());
    EXPECT_NEAR(fit.delay_s, delay_s, 2e-5);
    EXPECT_NEAR(fit.gain, pair.gain, 1e-4);
    EXPECT_GT(fit.explained, 0.9999);
    EXPECT_FALSE(fit.ambiguous);
  }
}

TEST(Delay, GapsInTheForceSensorAreNotCompared) {
  const VirtualPair pair{.noise_N = 1e-3};
  auto trace = pair.sensor();
  std::erase_if(trace, [](const TimedForce& s) { return s.time_s > 8.0 && s.time_s < 10.0; });
  const DelayFit fit = identify_delay(pair.tracker(1), trace);
  EXPECT_NEAR(fit.delay_s, 0.037, 4.0 * fit.sigma_s);
  for (const double t : fit.times_s) EXPECT_FALSE(t - fit.delay_s > 8.02 && t - fit.delay_s < 9.98);
}

TEST(Delay, ARhythmAloneIsAmbiguous) {
  const VirtualPair pair{.periodic = true};
  const DelayFit fit = identify_delay(pair.tracker(1), pair.sensor(), {.max_delay_s = 1.1});
  ASSERT_TRUE(fit.rival);
  EXPECT_TRUE(fit.ambiguous);
  // Noise cannot choose; the smaller shift is taken.
  EXPECT_NEAR(fit.delay_s, 0.037, 4.0 * fit.sigma_s);
  EXPECT_NEAR(std::abs(fit.rival->delay_s - fit.delay_s), 1.0 / 1.2, 0.02);
  // Within half a period there is one answer.
  EXPECT_FALSE(identify_delay(pair.tracker(1), pair.sensor(), {.max_delay_s = 0.4}).ambiguous);
}

std::string refusal(const std::vector<TimedForce>& felt, const std::vector<TimedForce>& trace, double max_s = 0.5) {
  try {
    identify_delay(felt, trace, {.max_delay_s = max_s});
  } catch (const InputError& error) {
    return error.what();
  }
  return "no refusal";
}

TEST(Delay, RefusesWhatCannotTell) {
  const VirtualPair pair;
  EXPECT_THAT(refusal(pair.tracker(1), pair.sensor(30.0, 50.0)), HasSubstr("only 0 samples"));
  EXPECT_THAT(refusal(pair.tracker(1), pair.sensor(0.0, 1.3)), HasSubstr("expected at least 20"));
  EXPECT_THAT(refusal(pair.tracker(1), pair.sensor(), 0.02), HasSubstr("at the edge of the range"));
  EXPECT_THAT(refusal({}, pair.sensor()), HasSubstr("no force"));
  EXPECT_THAT(refusal(pair.tracker(1), pair.sensor(0.0, 0.001)), HasSubstr("one sample"));
  Draws draws(5);
  auto flat = pair.tracker(1);
  for (TimedForce& s : flat) s.force_N = 5e-3 * draws.normal3();
  EXPECT_THAT(refusal(flat, pair.sensor()), HasSubstr("not alike"));
  auto trace = pair.sensor();
  for (TimedForce& s : trace) s.force_N.setConstant(0.1);
  EXPECT_THAT(refusal(flat, trace), HasSubstr("the force does not change"));
  for (TimedForce& s : trace) s.force_N = 1e-3 * draws.normal3();
  EXPECT_THAT(refusal(flat, trace), HasSubstr("the force does not change"));
  // A ramp: a shift is an offset.
  for (TimedForce& s : trace) s.force_N = Vector3d(1, 2, 3) * 0.01 * s.time_s;
  for (TimedForce& s : flat) s.force_N = Vector3d(1, 2, 3) * 0.01 * s.time_s + 1e-3 * draws.normal3();
  EXPECT_NE(refusal(flat, trace), "no refusal");
  // The force of the tip on the tissue instead.
  auto turned = pair.tracker(1);
  for (TimedForce& s : turned) s.force_N = -s.force_N;
  EXPECT_FALSE(identify_delay(pair.tracker(1), pair.sensor()).ambiguous);
  const std::string said = refusal(turned, pair.sensor(), 0.15);
  EXPECT_NE(said, "no refusal") << said;
}

/// The force felt in a recording made by another program, its clock turned by known amounts.
TEST(Delay, HeartbeatRecording) {
  PALPATE_NEEDS_SHARED("recordings/heartbeat.tracker.csv");
  const test::SharedRecording recording = test::shared_recording("heartbeat");
  ForceObserver observer(recording.catheter, {});
  SmoothingPass smoothing(observer);
  for (const TrackerFrame& frame : recording.frames) smoothing.add(observer, frame, observer.update(frame));
  std::vector<TimedForce> felt, trace;
  for (const Estimate& e : smoothing.finish(observer))
    felt.push_back({e.time_s, e.force_tip_N, e.covariance_tip_N2.diagonal().cwiseSqrt()});
  for (const double shift_s : {0.0, 0.037, -0.12}) {
    trace.clear();
    // On a grid of its own, for else best and sample times would coincide.
    for (double t = recording.truth.times_s.front(); t < recording.truth.times_s.back(); t += 0.0107)
      trace.push_back({t - shift_s, recording.truth.interpolate(t).force_tip_N});
    const DelayFit fit = identify_delay(felt, trace);
    EXPECT_NEAR(fit.delay_s, shift_s, std::max(2e-3, 3.0 * fit.sigma_s));
    EXPECT_LT(fit.sigma_s, 2e-3);
    EXPECT_FALSE(fit.ambiguous);
  }
}

}  // namespace
}  // namespace palpate
