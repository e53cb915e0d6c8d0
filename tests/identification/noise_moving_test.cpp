// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <palpate/identification/noise_moving.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/tracker_recording.hpp>
#include <tests/random_draws.hpp>
#include <tests/shared_data.hpp>

namespace palpate {
namespace {

using test::Draws;

/// A sensor swept along a smooth path as a beating heart and a slow hand move it, seen with known white noise.
struct VirtualMotion {
  double sigma_m = 0.2e-3, sigma_rad = 3e-3;
  double amplitude_m = 8e-3, amplitude_rad = 0.3, frequency_Hz = 0.5;
  double jitter = 0.3;   ///< of a frame time
  double dropout = 0.1;  ///< share of frames without the sensor
  double repeat = 0.0;   ///< share of frames that repeat the one before
  double outlier = 0.0;  ///< share of readings off by centimetres

  std::vector<TrackerFrame> frames(std::size_t count, unsigned seed) const {
    Draws draws(seed);
    const Pose start{draws.rotation(), draws.in_ball(0.2)};
    std::vector<TrackerFrame> frames(count);
    for (std::size_t i = 0; i < count; ++i) {
      frames[i].time_s = 0.025 * (static_cast<double>(i) + jitter * draws.uniform(-0.5, 0.5));
      frames[i].readings = {reading(start, frames[i].time_s, draws)};
      if (i > 0 && draws.uniform(0.0, 1.0) < repeat) frames[i].readings = frames[i - 1].readings;
    }
    return frames;
  }

 private:
  SensorReading reading(const Pose& start, double time_s, Draws& draws) const {
    SensorReading r;
    r.has_orientation = true;
    if (draws.uniform(0.0, 1.0) < dropout) return r;
    r.status = SensorReading::Status::kOk;
    const double phase = 2.0 * std::numbers::pi * frequency_Hz * time_s;
    const Vector3d way(std::sin(phase), std::cos(0.7 * phase), std::sin(1.3 * phase + 1.0));
    r.position_m = start.p + amplitude_m * way + sigma_m * draws.normal3();
    if (draws.uniform(0.0, 1.0) < outlier) r.position_m += 0.03 * draws.normal3();
    const Matrix3d R = start.R * Draws::turn(amplitude_rad * way) * Draws::turn(sigma_rad * draws.normal3());
    const Eigen::Quaterniond q(R);
    r.quaternion_wxyz << q.w(), q.x(), q.y(), q.z();
    return r;
  }
};

MovingNoise moving_noise(const VirtualMotion& motion, std::size_t count, unsigned seed) {
  return identify_moving_noise(collect_samples(motion.frames(count, seed), 0));
}

/// Over seeds: within 10 % of the truth, and off by as much as the sigmas say.
void expect_recovered(const VirtualMotion& motion) {
  double squares = 0.0;
  constexpr int kSeeds = 4;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const MovingNoise noise = moving_noise(motion, 1500, seed);
    ASSERT_EQ(noise.untold, "");
    for (int k = 0; k < 6; ++k) {
      const MovingChannel& channel = noise.channels[static_cast<std::size_t>(k)];
      const double miss = channel.sigma / (k < 3 ? motion.sigma_m : motion.sigma_rad) - 1.0;
      EXPECT_LT(std::abs(miss), 0.1) << "channel " << k << " seed " << seed;
      EXPECT_NEAR(channel.nis, 1.0, 0.15);
      squares += std::pow(miss / channel.sigma_fraction, 2) / (6.0 * kSeeds);
    }
  }
  EXPECT_GT(squares, 0.4);
  EXPECT_LT(squares, 2.0);
}

TEST(MovingNoise, KnownNoiseOnASmoothPath) { expect_recovered({}); }
TEST(MovingNoise, RepeatedRowsDoNotMakeItSmall) { expect_recovered({.repeat = 0.4}); }
TEST(MovingNoise, OutliersDoNotMakeItLarge) {
  const VirtualMotion motion{.outlier = 0.02};
  expect_recovered(motion);
  EXPECT_NEAR(static_cast<double>(moving_noise(motion, 1500, 1).channels[0].outliers), 0.02 * 1350, 14);
}
TEST(MovingNoise, AtRestToo) { expect_recovered({.amplitude_m = 0.0, .amplitude_rad = 0.0}); }

/// What the filter cannot follow it must not call noise without a word.
TEST(MovingNoise, MotionThatIsNoneOfItsModelIsTold) {
  EXPECT_TRUE(moving_noise({}, 1500, 1).holds());
  // Six cycles a second of 8 mm are, at 40 Hz, 6.7 readings a cycle.
  const MovingNoise fast = moving_noise({.frequency_Hz = 6.0}, 1500, 1);
  EXPECT_FALSE(fast.holds());
  EXPECT_GT(fast.channels[0].correlation, 0.2);
}

/// A recording made by another program: 0.28 mm and 0.17 deg. Where contact is made and lost the motion is none that a
/// filter follows; the channels that say so are those to distrust.
TEST(MovingNoise, ChannelsThatHoldAreRight) {
  PALPATE_NEEDS_SHARED("recordings/heartbeat.tracker.csv");
  const auto recording = read_tracker_recording(test::shared_data("recordings/heartbeat.tracker.csv"));
  int holding = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const MovingNoise noise = identify_moving_noise(collect_samples(recording.frames, i));
    EXPECT_FALSE(noise.holds());
    for (std::size_t k = 0; k < 6; ++k) {
      if (!noise.channels[k].holds()) continue;
      ++holding;
      const double truth = k < 3 ? 0.28e-3 : 0.17 * kRadiansPerDegree;
      EXPECT_NEAR(noise.channels[k].sigma / truth, 1.0, 0.15) << recording.sensor_names[i] << " channel " << k;
    }
  }
  EXPECT_GE(holding, 6);
}

TEST(MovingNoise, TooLittleIsSaidNotGuessed) {
  EXPECT_EQ(moving_noise({.dropout = 0.0}, 29, 1).untold,
            "29 usable readings, 29 of them distinct: expected at least 30 distinct ones");
  EXPECT_NE(moving_noise({.dropout = 1.0}, 100, 1).untold, "");
  // A sensor that does not change at all.
  EXPECT_NE(moving_noise({.dropout = 0.0, .repeat = 1.0}, 100, 1).untold, "");
}

}  // namespace
}  // namespace palpate
