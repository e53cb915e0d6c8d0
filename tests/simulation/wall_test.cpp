// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <tests/simulation/scenarios.hpp>

/// Contact with a compliant wall.
namespace palpate {
namespace {

using test::scenario_of, test::steady;

/// A wall before the bent catheter's tip, askew to it, that starts `gap_m` away.
WallLoad wall_at(const Catheter& catheter, const Vector3d& normal, double gap_m) {
  const Truth free = test::first_truth(scenario_of(catheter, ForceLoad{}));
  WallLoad wall{.stiffness_N_per_m = 300.0};
  wall.normal_base = normal;
  wall.point_base_m = free.T_base_tip * catheter.rod.contact_offset_m - gap_m * normal.normalized();
  return wall;
}

struct WallForce {
  double depth_m, normal_N;
  Vector3d along_N;
};

WallForce wall_force(const Scenario& scenario, const Truth& truth, double wall_m) {
  const auto& wall = std::get<WallLoad>(scenario.load);
  const Vector3d n = wall.normal_base.normalized();
  const double normal_N = n.dot(truth.force_base_N);
  return {wall_m + n.dot(wall.point_base_m - test::contact_point(scenario, truth)), normal_N,
          truth.force_base_N - normal_N * n};
}

TEST(Wall, ForceIsStiffnessTimesDepthAndStaysInTheFrictionCone) {
  const Catheter catheter = test::two_sensors();
  WallLoad wall = wall_at(catheter, {0.2, 0.4, -1.0}, 1e-3);
  wall.along_normal_m.sines = {{.amplitude = 6e-3, .frequency_hz = 0.7}};
  wall.tangential_stiffness_N_per_m = 200.0;
  wall.friction = 0.25;
  const Scenario scenario = scenario_of(catheter, wall, 4.0);
  int touching = 0, sticking = 0, slipping = 0;
  const VirtualRun run = run_scenario(scenario);
  for (const Truth& truth : run.truth) {
    const WallForce at = wall_force(scenario, truth, wall.along_normal_m.at(truth.time_s));
    EXPECT_NEAR(at.normal_N, std::max(0.0, 300.0 * at.depth_m), 1e-9);
    EXPECT_LE(at.along_N.norm(), 0.25 * at.normal_N + 1e-12);
    EXPECT_EQ(truth.in_contact, at.depth_m > 0.0);
    if (!truth.in_contact) {
      EXPECT_EQ(truth.force_base_N.norm(), 0.0);
      continue;
    }
    ++touching;
    ++(at.along_N.norm() > (0.25 - 1e-9) * at.normal_N ? slipping : sticking);
  }
  EXPECT_GT(touching, 40);
  EXPECT_GT(slipping, 5);
  EXPECT_GT(sticking, 5);
  ASSERT_GE(run.events.size(), 4U);
  EXPECT_EQ(run.events[0].what, "contact made");
  EXPECT_EQ(run.events[1].what, "contact lost");
}

/// In and out again. The shaft gives back what it took; what the wall's motion has put in is what friction took, and
/// nothing without friction. The forces are of 0.03 N over 5 mm: 1e-4 J.
TEST(Wall, WorkOverAContactIsWhatFrictionTakes) {
  const Catheter catheter = test::two_sensors();
  struct Work {
    double on_catheter_J = 0.0, by_motion_J = 0.0;
  };
  const auto over_contact = [&](double friction) {
    WallLoad wall = wall_at(catheter, {0.2, 0.4, -1.0}, 1e-3);
    wall.along_normal_m.points = {{0.0, 0.0}, {2.0, 5e-3}, {4.0, 0.0}};
    wall.tangential_stiffness_N_per_m = 200.0;
    wall.friction = friction;
    const Scenario scenario = scenario_of(catheter, wall, 4.1);
    const VirtualRun run = run_scenario(scenario);
    const Vector3d n = wall.normal_base.normalized();
    Work work;
    for (std::size_t i = 1; i < run.truth.size(); ++i) {
      const Truth &from = run.truth[i - 1], &to = run.truth[i];
      const Vector3d force_N = 0.5 * (to.force_base_N + from.force_base_N);
      work.on_catheter_J += force_N.dot(test::contact_point(scenario, to) - test::contact_point(scenario, from));
      work.by_motion_J += n.dot(force_N) * (wall.along_normal_m.at(to.time_s) - wall.along_normal_m.at(from.time_s));
    }
    return work;
  };
  const Work smooth = over_contact(0.0), rough = over_contact(0.3);
  EXPECT_LT(std::abs(smooth.on_catheter_J), 1e-7);
  EXPECT_LT(std::abs(smooth.by_motion_J), 1e-7);
  EXPECT_LT(std::abs(rough.on_catheter_J), 1e-6);
  EXPECT_GT(rough.by_motion_J, 1e-6);
}

/// A straight shaft below Euler's load does not give along its axis.
TEST(Wall, OnTheAxisOfAStraightShaftItIsASpring) {
  const Catheter catheter = test::straight(test::two_sensors());
  WallLoad wall{.point_base_m = {0.0, 0.0, 0.0701}, .stiffness_N_per_m = 300.0};
  wall.along_normal_m = test::ramp(3e-4, 1.0);
  const VirtualRun run = run_scenario(scenario_of(catheter, wall), {.stable_only = true});
  for (const Truth& truth : run.truth)
    EXPECT_NEAR(truth.force_tip_N.z(), -300.0 * std::max(0.0, 3e-4 * truth.time_s - 1e-4), 1e-10);
  EXPECT_LT(run.truth.back().force_tip_N.z(), -0.05);
}

/// Cantilever against a side wall: F = k d / (1 + k L^3 / (3 EI)).
TEST(Wall, AtTheSideOfAStraightShaftItIsASpringBehindACantilever) {
  const Catheter catheter = test::straight(test::two_sensors());
  for (const double k : {5.0, 300.0, 1e6}) {
    WallLoad wall{.point_base_m = Vector3d::Zero(), .normal_base = Vector3d::UnitX(), .stiffness_N_per_m = k};
    wall.along_normal_m = test::ramp(1e-3, 1.0);
    const Truth truth = run_scenario(scenario_of(catheter, wall, 1.025)).truth.back();
    const double compliance = std::pow(0.07, 3) / (3.0 * 1.6664e-4);  // bending about d2
    EXPECT_NEAR(truth.force_base_N.x(), k * 1e-3 / (1.0 + k * compliance), 0.01 * truth.force_base_N.x()) << k;
  }
}

/// Friction holds the tip of a straight shaft: clamped and pinned, it buckles at 20.19 EI / L^2; the tangential spring
/// makes that a little less. Without friction the tip slides at pi^2 / 4 EI / L^2.
TEST(Wall, FrictionDecidesWhereAPushedShaftBuckles) {
  const Catheter catheter = test::straight(test::two_sensors());
  const auto load_at_loss_N = [&](double friction) {
    WallLoad wall{.point_base_m = {0.0, 0.0, 0.0701}, .stiffness_N_per_m = 300.0};
    wall.tangential_stiffness_N_per_m = 1e5, wall.friction = friction;
    wall.along_normal_m = test::ramp(3e-3, 3.0);
    for (const ScenarioEvent& event : run_scenario(scenario_of(catheter, wall, 3.0)).events) {
      double time_s = 0.0, force_N = 0.0;
      if (event.instability && std::sscanf(event.what.c_str(), "at %lf s, %lf N", &time_s, &force_N) == 2)
        return force_N;
    }
    return 0.0;
  };
  const double EI_per_L2 = 1.6664e-4 / (0.07 * 0.07);
  EXPECT_NEAR(load_at_loss_N(0.0), 2.4674 * EI_per_L2, 0.001 * 2.4674 * EI_per_L2);
  EXPECT_NEAR(load_at_loss_N(0.5), 20.19 * EI_per_L2, 0.002 * 20.19 * EI_per_L2);
}

TEST(Wall, StartingInsideTheCatheterIsRefusedWithDepthAndPlace) {
  const Catheter catheter = test::straight(test::two_sensors());
  const WallLoad wall{.point_base_m = {0.0, 0.0, 0.068}, .stiffness_N_per_m = 300.0};
  EXPECT_EQ(test::refusal(scenario_of(catheter, wall)),
            "load.point_base_m: at the start the wall reaches 0.002 m beyond the catheter's contact point at [0, 0, "
            "0.07] m (base frame): expected a wall that starts clear of it");
}

/// Frames do not decide what happens: half of them, the same forces at the frames that are left.
TEST(Wall, ForceDoesNotDependOnTheFrameRate) {
  const Catheter catheter = test::two_sensors();
  WallLoad wall = wall_at(catheter, {0.0, 0.3, -1.0}, 5e-4);
  wall.heart = {.beats_per_min = 75.0, .amplitude_m = 4e-3, .interval_spread = 0.1, .size_spread = 0.1};
  Scenario scenario = scenario_of(catheter, wall, 4.0);
  const VirtualRun coarse = run_scenario(scenario);
  scenario.tracker.rate_hz = 80.0;
  const VirtualRun fine = run_scenario(scenario);
  for (std::size_t i = 0; i < coarse.truth.size(); ++i)
    EXPECT_LT((coarse.truth[i].force_tip_N - fine.truth[2 * i].force_tip_N).norm(), 1e-10);
}

TEST(Wall, BeatsAndRubsFor2000FramesOnOneBranch) {
  const Catheter catheter = test::two_sensors();
  WallLoad wall = wall_at(catheter, {0.0, 0.3, -1.0}, 5e-4);
  wall.heart = {.beats_per_min = 75.0, .amplitude_m = 4e-3, .interval_spread = 0.1, .size_spread = 0.1};
  wall.tangential_stiffness_N_per_m = 200.0, wall.friction = 0.3;
  const VirtualRun run = run_scenario(scenario_of(catheter, wall, 50.0));
  EXPECT_EQ(run.truth.size(), 2000U);
  for (const ScenarioEvent& event : run.events) EXPECT_FALSE(event.instability) << event.what;
}

}  // namespace
}  // namespace palpate
