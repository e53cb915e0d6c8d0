// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <palpate/math/errors.hpp>
#include <palpate/sensing/tendon_map.hpp>
#include <tests/observer/allocation_counter.hpp>
#include <tests/random_draws.hpp>

namespace palpate {
namespace {

using Eigen::Vector2d;
using test::Draws;
using ::testing::HasSubstr;

/// k1 = 20 u on the pull branch, 4 1/m more on release, over [0, 2]; k2 goes from 1 to 2 across the loop.
TendonMap straight_branches() {
  TendonMap map;
  map.present = true;
  map.position = {0.0, 0.5, 2.0};
  map.sigma_per_m = {0.3, 0.1};
  for (const double u : map.position) {
    map.pull_per_m.emplace_back(20.0 * u, 1.0);
    map.release_per_m.emplace_back(20.0 * u + 4.0, 2.0);
  }
  return map;
}

/// The play operator on the position, with threshold r: w = max(u - r, min(u + r, w)); here k = 20 (w + r).
struct BruteForcePlay {
  double r, w;
  double k1(double u) {
    w = std::max(u - r, std::min(u + r, w));
    return 20.0 * (w + r);
  }
};

TEST(TendonPlay, IsAPlayOperatorBetweenStraightBranches) {
  const TendonPlay play(straight_branches(), {7.0, 0.5});
  TendonPlay::Memory memory;
  BruteForcePlay reference{0.1, 0.0};
  Draws draws(4);
  double u = 0.0;
  play.advance(0.0, memory);
  reference.k1(0.0);
  play.advance(0.3, memory);  // across the dead zone: now the past is known
  reference.k1(0.3);
  for (int i = 0; i < 500; ++i) {
    u = std::clamp(u + draws.uniform(-0.3, 0.3), 0.0, 2.0);
    const BendReading bend = play.advance(u, memory);
    const double k1 = reference.k1(u), share = (k1 - 20.0 * u) / 4.0;
    EXPECT_NEAR(bend.change_per_m.x(), k1 - 7.0, 1e-9);
    EXPECT_NEAR(bend.change_per_m.y(), 1.0 + share - 0.5, 1e-9);
    EXPECT_NEAR(bend.sigma_per_m.x(), 0.3, 1e-9);
    EXPECT_TRUE(bend.present && bend.inside);
  }
}

TEST(TendonPlay, UnknownPastIsPartOfTheSigmaUntilTheDeadZoneIsCrossed) {
  const TendonPlay play(straight_branches(), {0.0, 0.0});
  TendonPlay::Memory memory;
  const BendReading first = play.advance(1.0, memory);
  EXPECT_NEAR(first.change_per_m.x(), 22.0, 1e-12);
  EXPECT_NEAR(first.sigma_per_m.x(), std::hypot(0.3, 4.0 / std::sqrt(12.0)), 1e-12);
  const BendReading half = play.advance(1.1, memory);  // pulled by half of the dead zone
  EXPECT_NEAR(half.change_per_m.x(), 23.0, 1e-12);
  EXPECT_NEAR(half.sigma_per_m.x(), std::hypot(0.3, 2.0 / std::sqrt(12.0)), 1e-12);
  EXPECT_NEAR(play.advance(1.2, memory).sigma_per_m.x(), 0.3, 1e-12);
  EXPECT_NEAR(play.advance(1.2, memory).change_per_m.x(), 24.0, 1e-12);
}

TEST(TendonPlay, TheWayBetweenTwoPositionsDoesNotMatterUnlessItTurns) {
  const TendonPlay play(straight_branches(), {0.0, 0.0});
  TendonPlay::Memory at_once, in_steps;
  play.advance(0.0, at_once);
  play.advance(0.0, in_steps);
  for (int i = 1; i <= 100; ++i) play.advance(0.015 * i, in_steps);
  EXPECT_DOUBLE_EQ(play.advance(1.5, at_once).change_per_m.x(), play.advance(1.5, in_steps).change_per_m.x());
}

TEST(TendonPlay, BeyondTheMapItHoldsTheEndAndTheSigmaGrows) {
  const TendonPlay play(straight_branches(), {0.0, 0.0});
  TendonPlay::Memory memory;
  play.advance(0.0, memory);
  const BendReading end = play.advance(2.0, memory), beyond = play.advance(2.5, memory);
  EXPECT_TRUE(end.inside);
  EXPECT_FALSE(beyond.inside);
  EXPECT_DOUBLE_EQ(beyond.change_per_m.x(), end.change_per_m.x());
  EXPECT_NEAR(beyond.sigma_per_m.x(), std::hypot(0.3, 0.5 * 20.0), 1e-9);
  EXPECT_FALSE(play.advance(std::nan(""), memory).present);
  EXPECT_DOUBLE_EQ(play.advance(2.5, memory).change_per_m.x(), beyond.change_per_m.x());
}

TEST(TendonPlay, CurveIsMonotoneBetweenItsEntriesWhicheverWayItGoes) {
  for (const double sense : {1.0, -1.0}) {
    TendonMap map;
    map.present = true;
    map.position = {0.0, 1.0, 2.0, 3.0, 4.0};
    map.sigma_per_m = {0.3, 0.1};
    for (const double k : {0.0, 0.0, 1.0, 30.0, 30.5}) {  // a plateau, a jump
      map.pull_per_m.emplace_back(sense * k, 0.0);
      map.release_per_m.emplace_back(sense * (k + 1.0), 0.0);
    }
    map.validate();
    const TendonPlay play(map, {0.0, 0.0});
    double before = 0.0;
    TendonPlay::Memory memory;
    for (int i = 0; i <= 400; ++i) {
      const double pull = sense * play.pull_per_m(0.01 * i).x();
      EXPECT_GE(pull, before - 1e-12);
      before = pull;
      const double live = sense * play.advance(0.01 * i, memory).change_per_m.x();
      EXPECT_GE(live, pull - 1e-12);
      EXPECT_LE(live, sense * play.release_per_m(0.01 * i).x() + 1e-12);
    }
  }
}

TEST(TendonPlay, DoesNotAllocate) {
  const TendonPlay play(straight_branches(), {0.0, 0.0});
  TendonPlay::Memory memory;
  double sum = 0.0;
  const test::CountAllocations count;
  for (int i = 0; i < 1000; ++i) sum += play.advance(std::abs(std::sin(0.01 * i)), memory).change_per_m.x();
  EXPECT_EQ(count.so_far(), 0u);
  EXPECT_GT(sum, 0.0);
}

TEST(TendonMap, RefusesWhatIsNoMap) {
  const auto refusal = [](const TendonMap& map) -> std::string {
    try {
      map.validate();
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal(straight_branches()), "accepted");
  TendonMap map = straight_branches();
  std::swap(map.pull_per_m, map.release_per_m);
  EXPECT_THAT(refusal(map), HasSubstr("are the branches exchanged?"));
  map = straight_branches();
  map.position[1] = 3.0;
  EXPECT_THAT(refusal(map), HasSubstr("position[2] = 2: expected more than the one before"));
  map = straight_branches();
  map.pull_per_m[1].x() = -1.0;
  EXPECT_THAT(refusal(map), HasSubstr("pull_k1_per_m[1] = -1: expected a branch that only rises"));
  map = straight_branches();
  map.sigma_per_m.x() = 0.0;
  EXPECT_THAT(refusal(map), HasSubstr("sigma_per_m"));
  map = straight_branches();
  map.position.pop_back();
  EXPECT_THAT(refusal(map), HasSubstr("expected equal numbers"));
}

}  // namespace
}  // namespace palpate
