// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <palpate/identification/tendon_map.hpp>
#include <palpate/math/errors.hpp>
#include <tests/random_draws.hpp>

/// Maps found from samples of a handle that has play, simulated apart from TendonPlay.
namespace palpate {
namespace {

using Eigen::Vector2d;
using test::Draws;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double kTravel_rad = 2.0, kThreshold_rad = 0.12;

/// Play of half width r in front of a soft curve; it has been released to 0 before.
struct Handle {
  double w = kThreshold_rad;
  Vector2d at(double knob) {
    w = std::max(knob - kThreshold_rad, std::min(knob + kThreshold_rad, w));
    return {60.0 * std::sin(0.5 * std::numbers::pi * std::max(w, 0.0) / 2.2), 1.0 + 0.5 * w};
  }
};

/// Up and down over the whole range, `turns` times, in `steps` steps each way.
std::vector<HandleSample> loop(int steps, double noise_per_m, Draws& draws, int turns = 1) {
  Handle handle;
  std::vector<HandleSample> samples;
  for (int i = 0; i < 2 * steps * turns; ++i) {
    const int phase = i % (2 * steps);
    const bool release = phase >= steps;
    const double knob = kTravel_rad * (release ? 2 * steps - 1 - phase : phase) / (steps - 1.0);
    const Vector2d k = handle.at(knob) + noise_per_m * Vector2d(draws.normal(), draws.normal());
    samples.push_back({knob, release, k, {noise_per_m, noise_per_m}});
  }
  return samples;
}

TEST(TendonMapFit, RecoversTheLoop) {
  Draws draws(11);
  const TendonMapFit fit = fit_tendon_map(loop(24, 0.2, draws, 2), TendonInput::kKnob);
  const TendonPlay play(fit.map, Vector2d::Zero());
  Handle up, down;
  up.at(0.0);
  down.at(kTravel_rad);
  double worst = 0.0, squares = 0.0;
  int count = 0;
  for (double knob = 0.0; knob <= kTravel_rad; knob += 0.02, ++count) {
    const double pull = (play.pull_per_m(knob) - up.at(knob)).x(),
                 release = (play.release_per_m(kTravel_rad - knob) - down.at(kTravel_rad - knob)).x();
    worst = std::max({worst, std::abs(pull), std::abs(release)});
    squares += 0.5 * (pull * pull + release * release);
  }
  std::printf(
      "map against the truth: rms %.3f, worst %.3f 1/m, sigma of the map %.3f, width %.2f, dead zone %.3f rad\n",
      std::sqrt(squares / count), worst, fit.map.sigma_per_m.x(), fit.mean_width_per_m, fit.dead_zone);
  EXPECT_LT(std::sqrt(squares / count), 0.25);
  EXPECT_LT(worst, 1.2);  // beside the kinks where the dead zone ends
  EXPECT_NEAR(fit.dead_zone, 2.0 * kThreshold_rad, 0.05);
  EXPECT_LT(fit.map.sigma_per_m.x(), 0.5);
}

/// A history that the map has never seen: 95 % of the values are within its intervals.
TEST(TendonMapFit, IsHonestForAnyHistory) {
  int inside = 0, all = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Draws draws(seed);
    const TendonMapFit fit = fit_tendon_map(loop(20, 0.4, draws, 2), TendonInput::kKnob);
    const TendonPlay play(fit.map, Vector2d::Zero());
    TendonPlay::Memory memory;
    Handle handle;
    double knob = 0.0;
    for (int i = 0; i < 100; ++i) {
      knob = std::clamp(knob + draws.uniform(-0.6, 0.6), 0.0, kTravel_rad);
      const BendReading bend = play.advance(knob, memory);
      const Vector2d error = bend.change_per_m - handle.at(knob);
      inside += std::abs(error.x()) <= 1.959964 * bend.sigma_per_m.x();
      ++all;
    }
  }
  const double share = 100.0 * inside / all;
  std::printf("any history: 95 %% intervals of k1,0 cover %.1f %%\n", share);
  EXPECT_GE(share, 90.0);
}

TEST(TendonMapFit, MeasurementNoiseIsNotTakenForScatterOfTheShaft) {
  Draws draws(2);
  std::vector<HandleSample> samples = loop(40, 0.5, draws, 3);
  const double stated = fit_tendon_map(samples, TendonInput::kKnob).map.sigma_per_m.x();
  const double common = fit_tendon_map(samples, TendonInput::kKnob, true).map.sigma_per_m.x();
  for (HandleSample& sample : samples) sample.sigma_per_m.setZero();
  const double silent = fit_tendon_map(samples, TendonInput::kKnob).map.sigma_per_m.x();
  EXPECT_LT(stated, 0.35);
  EXPECT_NEAR(silent, 0.5, 0.15);
  EXPECT_NEAR(common, std::hypot(0.5, silent), 0.02);
}

TEST(TendonMapFit, WithoutReleaseThereIsOneBranchAndAWarning) {
  Draws draws(2);
  std::vector<HandleSample> samples = loop(12, 0.1, draws);
  std::erase_if(samples, [](const HandleSample& sample) { return sample.release; });
  const TendonMapFit fit = fit_tendon_map(samples, TendonInput::kTension);
  EXPECT_EQ(fit.mean_width_per_m, 0.0);
  EXPECT_THAT(fit.warnings, Contains(HasSubstr("no sample of the release branch")));
}

TEST(TendonMapFit, NoiseWithoutHysteresisGivesAUsableMap) {
  Draws draws(3);
  std::vector<HandleSample> samples;
  for (int i = 0; i < 40; ++i) {
    const double knob = i < 20 ? 0.1 * i : 0.1 * (39 - i);
    samples.push_back({knob, i >= 20, {30.0 * knob + 0.3 * draws.normal(), 0.0}, Vector2d::Zero()});
  }
  const TendonMapFit fit = fit_tendon_map(samples, TendonInput::kKnob);
  EXPECT_LT(fit.mean_width_per_m, 0.5);
  fit.map.validate();
}

TEST(TendonMapFit, RefusesWhatCannotBe) {
  const auto refusal = [](const std::vector<HandleSample>& samples) -> std::string {
    try {
      fit_tendon_map(samples, TendonInput::kKnob);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  Draws draws(9);
  std::vector<HandleSample> samples = loop(10, 0.1, draws);
  for (HandleSample& sample : samples) sample.release = !sample.release;
  EXPECT_THAT(refusal(samples), HasSubstr("are the directions exchanged?"));
  samples = loop(10, 0.1, draws);
  samples.resize(2);
  EXPECT_THAT(refusal(samples), HasSubstr("pull branch: 2 positions of the handle: expected three or more"));
  samples = loop(10, 0.1, draws);
  samples[3].precurvature_per_m.x() = std::nan("");
  EXPECT_THAT(refusal(samples), HasSubstr("handle sample 4: expected finite numbers"));
}

}  // namespace
}  // namespace palpate
