// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/simulation/contact_force.hpp>

/// Friction by hand: 1 mm deep in a wall of 1000 N/m, springs of 500 N/m along it, a coefficient of 0.5, so that it
/// slips at 0.5 N, with the springs 1 mm long.
namespace palpate {
namespace {

class Friction : public ::testing::Test {
 protected:
  /// The contact point comes to rest `along_m` further on; the force along the wall [N].
  double slide_to(double along_m) {
    const Place place{.place_room_m = {along_m, 0.0, 1e-3}};
    anchor_ = next_anchor(wall_, {}, anchor_, place.place_room_m);
    return contact_force(wall_, {}, anchor_, place).force_room_N.x();
  }

  const Load wall_ = WallLoad{.stiffness_N_per_m = 1000.0, .tangential_stiffness_N_per_m = 500.0, .friction = 0.5};
  Anchor anchor_;
};

TEST_F(Friction, HoldsThenSlips) {
  EXPECT_NEAR(slide_to(0.0), 0.0, 1e-12);
  EXPECT_NEAR(slide_to(0.8e-3), -0.4, 1e-12);
  EXPECT_NEAR(slide_to(3e-3), -0.5, 1e-12);
}

TEST_F(Friction, HoldsAgainAtOnceWhenTheSlidingTurns) {
  for (const double along_m : {0.0, 2e-3, 4e-3, 5e-3}) slide_to(along_m);
  EXPECT_NEAR(slide_to(4.6e-3), -0.3, 1e-12);
  EXPECT_NEAR(slide_to(4.0e-3), 0.0, 1e-12);
  EXPECT_NEAR(slide_to(2.0e-3), 0.5, 1e-12);
}

TEST_F(Friction, ForgetsItsPlaceWithoutContact) {
  slide_to(0.0);
  anchor_ = next_anchor(wall_, {}, anchor_, {0.0, 0.0, -1e-3});
  EXPECT_FALSE(anchor_);
  EXPECT_NEAR(slide_to(2e-3), 0.0, 1e-12);
}

}  // namespace
}  // namespace palpate
