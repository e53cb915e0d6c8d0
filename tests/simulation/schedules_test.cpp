// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/simulation/flow_force.hpp>
#include <palpate/simulation/heart.hpp>
#include <tests/simulation/scenarios.hpp>

/// Signals, handle, heart and flow: what moves in a scenario.
namespace palpate {
namespace {

using test::scenario_of, test::steady;

TEST(Signal, AddsConstantSinesAndCourse) {
  Signal signal{.constant = 1.0, .sines = {{.amplitude = 2.0, .frequency_hz = 0.25, .phase_rad = 0.0}}};
  EXPECT_DOUBLE_EQ(signal.at(1.0), 3.0);
  signal.points = {{1.0, 10.0}, {3.0, 20.0}};
  EXPECT_DOUBLE_EQ(signal.at(0.0), 11.0) << "held before the first point";
  EXPECT_NEAR(signal.at(2.0), 16.0, 1e-14);
  EXPECT_DOUBLE_EQ(signal.at(5.0), 23.0) << "and behind the last";
  signal.course = Signal::Course::kHold;
  EXPECT_NEAR(signal.at(2.0), 11.0, 1e-14);
}

TEST(Signal, SmoothCourseIsMonotoneBetweenItsPointsAndHasNoKink) {
  const Signal signal{.points = {{0.0, 0.0}, {1.0, 0.1}, {2.0, 5.0}, {4.0, 5.0}, {5.0, 3.0}},
                      .course = Signal::Course::kSmooth};
  for (const auto& [time_s, value] : signal.points) EXPECT_NEAR(signal.at(time_s), value, 1e-14);
  constexpr double h = 1e-4;
  for (double t = h; t < 5.0 - h; t += 1e-3) {
    const double rise = signal.at(t + h) - signal.at(t);
    EXPECT_GE(t < 3.999 ? rise : -rise, -1e-12) << t;
    EXPECT_NEAR(rise, signal.at(t) - signal.at(t - h), 1e-6) << t;
  }
}

/// T_base_tip stays, everything turns and shifts about and along the clamp's e3: a base that is not known to move.
TEST(Handle, TwistAndTranslationMoveEveryPoseRigidly) {
  Catheter catheter = test::with_second_tracker(test::with_tracked_base(test::mounted(test::two_sensors())));
  Scenario still = scenario_of(catheter, ForceLoad{.force_N = steady({0.02, -0.03, -0.05})});
  Scenario moving = still;
  moving.handle.twist_rad = test::ramp(1.5, 1.0);
  moving.handle.translation_m = {.sines = {{.amplitude = 0.02, .frequency_hz = 1.0}}};
  const VirtualRun a = run_scenario(still), b = run_scenario(moving);
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    const double t = a.truth[i].time_s;
    const Pose move{exp_so3({0.0, 0.0, moving.handle.twist_rad.at(t)}), {0.0, 0.0, moving.handle.translation_m.at(t)}};
    EXPECT_LT((b.truth[i].T_base_tip.p - a.truth[i].T_base_tip.p).norm(), 1e-14);
    EXPECT_LT((b.truth[i].T_tracker_base.p - (catheter.base.T_tracker_base * move).p).norm(), 1e-14);
    for (std::size_t k = 0; k < 3; ++k) {
      const Pose own = k == 1 ? *catheter.sensors[1].T_tracker_base : catheter.base.T_tracker_base;
      const TrackerFrame moved = test::moved(own * move * own.inverse(), a.frames[i]);
      EXPECT_LT((b.frames[i].readings[k].position_m - moved.readings[k].position_m).norm(), 1e-13);
      EXPECT_LT((test::rotation_of(b.frames[i].readings[k]) - test::rotation_of(moved.readings[k])).norm(), 1e-12);
    }
  }
}

/// A weight over a far pulley stays where it is in the room while the clamp turns under it.
TEST(Handle, LoadsStayInTheRoom) {
  Scenario scenario = scenario_of(test::two_sensors(), ForceLoad{.in_base = true, .force_N = steady({0.05, 0.0, 0.0})});
  scenario.handle.twist_rad = test::ramp(1.0, 1.0);
  for (const Truth& truth : run_scenario(scenario).truth) {
    const Vector3d expected = exp_so3({0.0, 0.0, -truth.time_s}) * Vector3d(0.05, 0.0, 0.0);
    EXPECT_LT((truth.force_base_N - expected).norm(), 1e-12);
    EXPECT_LT((truth.T_base_tip.R * truth.force_tip_N - expected).norm(), 1e-10);
  }
}

TEST(Handle, TendonBendsTheShaftAsItsModelSaysAndIsReadWithNoise) {
  Scenario scenario = scenario_of(test::straight(test::two_sensors()), ForceLoad{}, 100.0);
  scenario.handle = {.tendon = true, .moment_1_Nm = steady(5e-3), .moment_sigma_fraction = 0.02};
  const VirtualRun run = run_scenario(scenario);
  Catheter bent = scenario.catheter;
  bent.rod.sections[0].precurvature_per_m.x() = 5e-3 / 2.612e-4;
  EXPECT_LT((run.truth[0].T_base_tip.p - test::true_frame(bent, {}).T_base_tip.p).norm(), 1e-10);
  double square = 0.0;
  for (const TrackerFrame& frame : run.frames) {
    ASSERT_TRUE(frame.tendon.present);
    EXPECT_FALSE(frame.bend.present);
    EXPECT_DOUBLE_EQ(frame.tendon.sigma_Nm, 1e-4);
    square += std::pow((frame.tendon.moment_Nm.x() - 5e-3) / 1e-4, 2) / 4000.0;
  }
  EXPECT_NEAR(square, 1.0, 5.0 * std::sqrt(2.0 / 4000.0));
}

TEST(Handle, KnobGoesThroughTheTendonMapWithItsPlay) {
  Catheter catheter = test::two_sensors();
  catheter.tendon_map = {.present = true,
                         .position = {0.0, 1.0},
                         .pull_per_m = {{0.0, 0.0}, {40.0, 0.0}},
                         .release_per_m = {{5.0, 0.0}, {45.0, 0.0}},
                         .sigma_per_m = {0.5, 0.5}};
  Scenario scenario = scenario_of(catheter, ForceLoad{}, 4.0);
  scenario.handle.knob_rad.points = {{0.0, 0.0}, {2.0, 1.0}, {4.0, 0.0}};
  const VirtualRun run = run_scenario(scenario);
  ASSERT_EQ(run.knob_rad.size(), run.frames.size());
  EXPECT_NEAR(run.truth[40].precurvature_per_m.x(), 20.0, 1e-9) << "pulled";
  EXPECT_NEAR(run.truth[120].precurvature_per_m.x(), 25.0, 1e-9) << "released";
  scenario.catheter.tendon_map = {};
  EXPECT_EQ(test::refusal(scenario), "handle.knob_rad: expected a catheter with a tendon map over the knob's angle");
}

TEST(StiffnessFactor, DriftsAllStiffnessesAndIsInTheTruth) {
  Scenario scenario = scenario_of(test::two_sensors(), ForceLoad{.force_N = steady({0.02, -0.03, -0.05})});
  scenario.stiffness_factor = {.constant = 1.0, .points = {{0.0, 0.0}, {1.0, -0.15}}};
  const Truth truth = run_scenario(scenario).truth.back();
  const double factor = 1.0 - 0.15 * 0.975;
  Catheter softer = scenario.catheter;
  softer.rod.sections[0].stiffness_Nm2 *= factor;
  EXPECT_LT((truth.stiffness_Nm2 - softer.rod.sections[0].stiffness_Nm2).norm(), 1e-15);
  const TipLoad load{.force_tip_N = truth.force_tip_N};
  EXPECT_LT((truth.T_base_tip.p - test::true_frame(softer, load).T_base_tip.p).norm(), 1e-10);
}

/// 40000 steps of 0.2 memories: 4000 independent samples an axis; 5 standard deviations.
TEST(FlowForce, HasTheStatedSizeAndMemory) {
  FlowForce flow({.rms_N = 3e-3, .memory_s = 0.1}, 5);
  Eigen::Array3d square = Eigen::Array3d::Zero(), lag = square, last = flow.next(0.02).array() / 3e-3;
  constexpr int n = 40000;
  for (int i = 0; i < n; ++i) {
    const Eigen::Array3d z = flow.next(0.02).array() / 3e-3;
    square += z.square() / n, lag += z * last / n;
    last = z;
  }
  EXPECT_LT((square - 1.0).abs().maxCoeff(), 5.0 * std::sqrt(2.0 / 4000.0));
  EXPECT_LT((lag / square - std::exp(-0.2)).abs().maxCoeff(), 0.02);
}

/// The flow moves the shaft; the truth speaks of the tissue alone.
TEST(FlowForce, ActsBesideTheLoadAndIsNotInTheTruth) {
  Scenario scenario = scenario_of(test::two_sensors(), ForceLoad{.force_N = steady({0.02, -0.03, -0.05})});
  const VirtualRun calm = run_scenario(scenario);
  scenario.flow = {.rms_N = 3e-3, .memory_s = 0.1};
  const VirtualRun run = run_scenario(scenario);
  double moved_m = 0.0;
  for (std::size_t i = 0; i < run.truth.size(); ++i) {
    EXPECT_LT((run.truth[i].force_tip_N - Vector3d(0.02, -0.03, -0.05)).norm(), 1e-15);
    moved_m = std::max(moved_m, (run.truth[i].T_base_tip.p - calm.truth[i].T_base_tip.p).norm());
  }
  EXPECT_GT(moved_m, 5e-4);
}

/// 3000 beats: a mean scatters by spread / sqrt(3000), a standard deviation by about 1.3 % of itself.
TEST(Heartbeat, RateSizeAndTheirSpreadAreAsStated) {
  Heartbeat heart({.beats_per_min = 80.0, .amplitude_m = 5e-3, .interval_spread = 0.1, .size_spread = 0.2}, 3);
  std::vector<double> lengths_s, sizes_m;
  double start_s = 0.0, peak_m = 0.0, before_m = 0.0, falling = 0.0;
  constexpr double h = 1e-3;
  for (double t = h; lengths_s.size() < 3000; t += h) {
    const double x = heart.at(t);
    EXPECT_GE(x, 0.0);
    if (falling > 0.0 && x > before_m) {  // the wall is at rest between two beats
      lengths_s.push_back(t - start_s), sizes_m.push_back(peak_m);
      start_s = t, peak_m = 0.0;
    }
    falling = x < before_m ? 1.0 : 0.0;
    peak_m = std::max(peak_m, x), before_m = x;
  }
  const auto moments = [](const std::vector<double>& v) {
    double mean = 0.0, square = 0.0;
    for (const double x : v) mean += x / static_cast<double>(v.size());
    for (const double x : v) square += (x - mean) * (x - mean) / static_cast<double>(v.size());
    return std::pair(mean, std::sqrt(square));
  };
  const auto [length_s, length_sd_s] = moments(lengths_s);
  const auto [size_m, size_sd_m] = moments(sizes_m);
  EXPECT_NEAR(length_s, 0.75, 5.0 * 0.075 / std::sqrt(3000.0));
  EXPECT_NEAR(length_sd_s, 0.075, 0.007);
  EXPECT_NEAR(size_m, 5e-3, 5.0 * 1e-3 / std::sqrt(3000.0));
  EXPECT_NEAR(size_sd_m, 1e-3, 0.1e-3);
}

TEST(Heartbeat, RegularBeatIsARaisedCosine) {
  Heartbeat heart({.beats_per_min = 60.0, .amplitude_m = 4e-3}, 1);
  for (double t = 5.0; t > 0.0; t -= 0.01)
    EXPECT_NEAR(heart.at(t), 2e-3 * (1.0 - std::cos(2.0 * std::numbers::pi * t)), 1e-15);
}

TEST(ScenarioValidation, NamesFieldValueAndRange) {
  const auto error = [](auto change) {
    Scenario scenario = scenario_of(test::two_sensors(), WallLoad{.stiffness_N_per_m = 300.0});
    change(scenario, std::get<WallLoad>(scenario.load));
    return test::refusal(scenario);
  };
  EXPECT_EQ(error([](Scenario& s, WallLoad&) { s.duration_s = 0.0; }),
            "duration_s = 0: expected more than 0, at most 86400");
  EXPECT_EQ(error([](Scenario&, WallLoad& w) { w.stiffness_N_per_m = 0.0; }),
            "load.stiffness_N_per_m = 0: expected more than 0, at most 1e6");
  EXPECT_EQ(error([](Scenario&, WallLoad& w) { w.normal_base.setZero(); }),
            "load.normal_base: length = 0: expected a direction");
  EXPECT_EQ(error([](Scenario&, WallLoad& w) { w.heart.interval_spread = 0.5; }),
            "load.heart.interval_spread = 0.5: expected 0 to below 0.5");
  EXPECT_EQ(error([](Scenario& s, WallLoad&) { s.tracker.rate_hz = 2e4; }),
            "tracker.rate_hz = 20000: expected more than 0, at most 10000");
  EXPECT_EQ(error([](Scenario& s, WallLoad&) {
              s.handle.twist_rad.points = {{1.0, 0.0}, {1.0, 1.0}};
            }),
            "handle.twist_rad.points[1] time = 1: expected more than 1 of the point before");
  EXPECT_EQ(error([](Scenario& s, WallLoad&) { s.stiffness_factor = {.constant = 0.0}; }),
            "stiffness_factor = 0 at 0 s: expected 0.001 to 1000");
}

}  // namespace
}  // namespace palpate
