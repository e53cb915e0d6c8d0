// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <palpate/simulation/equilibrium_path.hpp>
#include <tests/rod/rod_cases.hpp>
#include <tests/simulation/scenarios.hpp>

/// The equilibria that run_scenario plays, against solutions made elsewhere, closed forms and the law of each load.
namespace palpate {
namespace {

using test::scenario_of, test::steady, test::first_truth;

constexpr double kGravity = 9.80665;

Load dead(const Vector3d& force_N) { return ForceLoad{.in_base = true, .force_N = steady(force_N)}; }
Load follower(const Vector3d& force_N) { return ForceLoad{.in_base = false, .force_N = steady(force_N)}; }

/// Poses as the tracker reports them; a tip moment is played as a tendon's end moment about d1.
TEST(VirtualRun, ShapesAreThoseOfTheReferenceFile) {
  PALPATE_NEEDS_SHARED(test::kRodStatics);
  int played = 0;
  for (const test::ReferenceRod& reference : test::reference_rods()) {
    if (reference.load.moment_tip_Nm.tail<2>().norm() > 0.0) continue;
    Catheter catheter = test::bare_catheter();
    catheter.rod = reference.rod;
    for (std::size_t i = 1; i < reference.stations.size() && catheter.sensors.size() < 8; i += 1)
      catheter.sensors.push_back(test::sensor_at(fmt::format("s{}", i), reference.stations[i].s_m));
    Scenario scenario = scenario_of(catheter, follower(reference.load.force_tip_N), 0.025);
    scenario.catheter.tendon.model = TendonModel::kEndMoment;
    scenario.handle.tendon = true;
    scenario.handle.moment_1_Nm = steady(reference.load.moment_tip_Nm.x());
    const VirtualRun run = run_scenario(scenario);
    for (std::size_t i = 0; i < catheter.sensors.size(); ++i) {
      const Pose T = catheter.base.T_tracker_base * reference.stations[i + 1].T_base_local;
      const SensorReading& reading = run.frames[0].readings[i];
      EXPECT_LT((reading.position_m - T.p).norm(), 1e-8 * reference.rod.length_m());
      EXPECT_LT(log_so3(T.R.transpose() * test::rotation_of(reading)).norm(), 1e-8);
    }
    EXPECT_LT((run.truth[0].force_base_N - reference.force_base_N).norm(),
              1e-8 * (1.0 + reference.force_base_N.norm()));
    ++played;
  }
  EXPECT_GE(played, 15);
}

/// All of them, with tip moments that no handle exerts.
TEST(VirtualRun, PathOfEquilibriaReachesEveryShapeOfTheReferenceFile) {
  PALPATE_NEEDS_SHARED(test::kRodStatics);
  const auto rods = test::reference_rods();
  EXPECT_EQ(rods.size(), 40U);
  for (const test::ReferenceRod& reference : rods) {
    Catheter catheter = test::bare_catheter();
    catheter.rod = reference.rod;
    for (const auto& station : reference.stations) catheter.sensors.push_back(test::sensor_at("s", station.s_m));
    const Load load = follower(reference.load.force_tip_N);
    EquilibriumPath path(catheter, load);
    Situation situation;
    situation.shaft.moment_tip_Nm = reference.load.moment_tip_Nm;
    situation.force_N = reference.load.force_tip_N;
    path.rest(situation);
    EXPECT_TRUE(path.follow(situation).empty());
    for (std::size_t i = 0; i < reference.stations.size(); ++i) {
      const Pose &ours = path.shape().points[i].T_base_local, &theirs = reference.stations[i].T_base_local;
      EXPECT_LT((ours.p - theirs.p).norm(), 1e-8 * reference.rod.length_m());
      EXPECT_LT(log_so3(theirs.R.transpose() * ours.R).norm(), 1e-8);
    }
  }
}

/// The same branch as base_loads.hpp follows, where that is stable, in space and in the plane.
TEST(VirtualRun, DeadLoadsAgreeWithTheRodsOwnContinuation) {
  const Catheter catheter = test::two_sensors();
  const RodSolver solver(catheter.rod, std::vector<double>{}, Accuracy::kReference);
  for (const Vector3d& F : {Vector3d(0.05, 0.0, 0.0), Vector3d(0.1, -0.2, 0.1), Vector3d(0.0, -0.1, -0.2),
                            Vector3d(-0.15, 0.05, -0.3), Vector3d(0.0, 0.09, 0.0)}) {
    const Equilibrium expected = follow_from_rest(solver, {.force_base_N = F, .tip = {}});
    ASSERT_EQ(expected.status, EquilibriumStatus::kStable);
    const Truth truth = first_truth(scenario_of(catheter, dead(F)));
    EXPECT_LT((truth.T_base_tip.p - expected.T_base_tip.p).norm(), 1e-10);
    EXPECT_LT((truth.force_tip_N - expected.load.force_tip_N).norm(), 1e-10);
    EXPECT_LT((truth.force_base_N - F).norm(), 1e-12);
  }
}

/// Pulling back in the bending plane: the shaft leaves the plane where base_loads.hpp says.
TEST(VirtualRun, LossOfStabilityIsWhereTheRodsOwnContinuationFindsIt) {
  const Catheter catheter = test::two_sensors();
  const RodSolver solver(catheter.rod, std::vector<double>{}, Accuracy::kReference);
  const Equilibrium expected = follow_from_rest(solver, {.force_base_N = {0.0, 0.2, 0.0}, .tip = {}});
  ASSERT_GT(expected.critical_load_factor, 0.0);
  Scenario scenario = scenario_of(catheter, dead({0.0, 0.2, 0.0}), 0.025);
  const VirtualRun run = run_scenario(scenario);
  ASSERT_EQ(run.events.size(), 1U);
  EXPECT_TRUE(run.events[0].instability);
  double told_N = 0.0;
  ASSERT_EQ(std::sscanf(run.events[0].what.c_str(), "at 0 s, %lf N", &told_N), 1) << run.events[0].what;
  EXPECT_NEAR(told_N, expected.critical_load_factor * 0.2, 1e-4 * 0.2);
  EXPECT_GT(std::abs(run.truth[0].T_base_tip.p.x()), 1e-3) << "out of the plane";
  EXPECT_LT((run.truth[0].force_base_N - Vector3d(0.0, 0.2, 0.0)).norm(), 1e-12);
}

TEST(VirtualRun, WeightOverAPulleyPullsTowardsItWithItsWeight) {
  PulleyLoad load{.mass_kg = 0.01303, .pulley_base_m = steady({0.03, -0.2, 0.05})};
  load.pulley_base_m[2].sines = {{.amplitude = 0.1, .frequency_hz = 0.5}};
  const Scenario scenario = scenario_of(test::two_sensors(), load, 2.0);
  const VirtualRun run = run_scenario(scenario);
  for (const Truth& truth : run.truth) {
    const Vector3d thread = at(load.pulley_base_m, truth.time_s) - test::contact_point(scenario, truth);
    EXPECT_LT((truth.force_base_N - 0.01303 * kGravity * thread.normalized()).norm(), 1e-10);
    EXPECT_LT((truth.T_base_tip.R * truth.force_tip_N - truth.force_base_N).norm(), 1e-12);
  }
  const Vector3d away = Vector3d(0.4, -0.7, -0.2).normalized();
  const Truth far = first_truth(
      scenario_of(test::two_sensors(), PulleyLoad{.mass_kg = 0.01303, .pulley_base_m = steady(Vector3d(1e6 * away))}));
  const Truth as_dead = first_truth(scenario_of(test::two_sensors(), dead(0.01303 * kGravity * away)));
  EXPECT_LT((far.T_base_tip.p - as_dead.T_base_tip.p).norm(), 1e-8);
}

/// In balance: the rod, asked directly for the shape under the true tip force, stands where the truth says.
TEST(VirtualRun, TruthIsAnEquilibriumAlsoOffTheFlexibleEndAndUnderOwnWeight) {
  Catheter catheter = test::with_own_weight(test::two_sensors());
  catheter.rod.contact_offset_m = {0.5e-3, -0.3e-3, 4e-3};
  WallLoad wall{.stiffness_N_per_m = 400.0, .tangential_stiffness_N_per_m = 300.0, .friction = 0.3};
  const Truth free = first_truth(scenario_of(catheter, follower(Vector3d::Zero())));
  wall.normal_base = {0.2, 0.5, -1.0};
  wall.point_base_m = free.T_base_tip * catheter.rod.contact_offset_m - 1e-4 * wall.normal_base;
  wall.along_normal_m = test::ramp(4e-3, 1.0);
  const VirtualRun run = run_scenario(scenario_of(catheter, wall));
  for (const Truth& truth : run.truth) {
    const TipLoad load{.force_tip_N = truth.force_tip_N};
    EXPECT_LT((test::true_frame(catheter, load).T_base_tip.p - truth.T_base_tip.p).norm(), 1e-10);
  }
  EXPECT_GT(run.truth.back().force_tip_N.norm(), 0.01);
}

TEST(VirtualRun, OverloadedColumnIsToldAtEulersLoadAndRefusedIfAsked) {
  const Catheter catheter = test::straight(test::two_sensors());
  ForceLoad push{.in_base = true};
  push.force_N[2] = test::ramp(-0.12, 6.0);
  const Scenario scenario = scenario_of(catheter, push, 6.0);
  const VirtualRun run = run_scenario(scenario);
  ASSERT_EQ(run.events.size(), 2U) << "contact, then the loss of stability";
  const ScenarioEvent& event = run.events[1];
  EXPECT_TRUE(event.instability);
  EXPECT_NEAR(event.time_s * 0.02, test::euler_load_N(catheter.rod), 1e-3 * test::euler_load_N(catheter.rod));
  EXPECT_NE(event.what.find("at 4.196 s, 0.08391 N"), std::string::npos) << event.what;
  EXPECT_GT(run.truth.back().T_base_tip.p.head<2>().norm(), 0.02) << "buckled";
  EXPECT_EQ(test::refusal(scenario, {.stable_only = true}),
            "load: at 4.196 s, 0.08391 N: the branch of equilibria followed from rest loses its stability: expected a "
            "stable load path");
}

/// A small imperfection and no instability: the shaft bends out to the side and the run is silent.
TEST(VirtualRun, ImperfectColumnBendsWithoutAnEvent) {
  ForceLoad push{.in_base = true};
  push.force_N = {steady(1e-4), steady(0.0), test::ramp(-0.12, 6.0)};
  const VirtualRun run =
      run_scenario(scenario_of(test::straight(test::two_sensors()), push, 6.0), {.stable_only = true});
  EXPECT_TRUE(run.events.empty());
  EXPECT_GT(run.truth.back().T_base_tip.p.x(), 0.02);
}

bool same_bits(const VirtualRun& a, const VirtualRun& b) {
  if (a.frames.size() != b.frames.size()) return false;
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    if (std::memcmp(a.truth[i].force_tip_N.data(), b.truth[i].force_tip_N.data(), 24) != 0) return false;
    for (std::size_t k = 0; k < a.frames[i].readings.size(); ++k) {
      const SensorReading &x = a.frames[i].readings[k], &y = b.frames[i].readings[k];
      if (std::memcmp(x.position_m.data(), y.position_m.data(), 24) != 0) return false;
      if (std::memcmp(x.quaternion_wxyz.data(), y.quaternion_wxyz.data(), 32) != 0) return false;
    }
  }
  return true;
}

/// Also where the load comes to rest, so that the path has nothing left to correct.
TEST(VirtualRun, EveryFramesReadingsShowTheShapeOfItsTruth) {
  Catheter catheter = test::bare_catheter();
  catheter.sensors = {test::sensor_at("tip", catheter.rod.length_m())};
  Load load = dead({0.0, 0.0, 0.0});
  std::get<ForceLoad>(load).force_N[1] = {.points = {{0.0, 0.0}, {0.5, 0.05}}};
  const VirtualRun run = run_scenario(scenario_of(catheter, load, 1.0));
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    const Pose T = run.truth[i].T_tracker_base * run.truth[i].T_base_tip;
    EXPECT_LT((run.frames[i].readings[0].position_m - T.p).norm(), 1e-12) << i;
  }
}

TEST(VirtualRun, SameSeedSameBitsAnotherSeedOthers) {
  Scenario scenario = scenario_of(test::two_sensors(), follower({0.02, 0.01, -0.05}));
  scenario.catheter = test::two_sensors();
  scenario.flow = {.rms_N = 3e-3, .memory_s = 0.2};
  scenario.seed = 7;
  const VirtualRun first = run_scenario(scenario);
  EXPECT_TRUE(same_bits(first, run_scenario(scenario)));
  scenario.seed = 8;
  EXPECT_FALSE(same_bits(first, run_scenario(scenario)));
}

TEST(VirtualRun, FramesThatNeverComeLeaveTheOthersAsTheyAre) {
  Scenario scenario = scenario_of(test::two_sensors(), follower({0.02, 0.01, -0.05}));
  scenario.catheter = test::two_sensors();
  scenario.tracker = {.jitter_s = 1e-3, .missing_share = 0.1};
  const VirtualRun all = run_scenario(scenario);
  scenario.tracker.dropped_share = 0.5;
  const VirtualRun some = run_scenario(scenario);
  EXPECT_LT(some.frames.size(), 30U);
  for (const TrackerFrame& frame : some.frames) {
    const TrackerFrame& same = all.frames.at(static_cast<std::size_t>(frame.number));
    EXPECT_EQ(frame.time_s, same.time_s);
    for (std::size_t i = 0; i < frame.readings.size(); ++i)
      EXPECT_EQ(frame.readings[i].position_m, same.readings[i].position_m);
  }
}

}  // namespace
}  // namespace palpate
