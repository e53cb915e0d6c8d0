// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/observer/smoothing.hpp>
#include <tests/observer/uncertain_setups.hpp>

/// The 95 % interval holds the truth 95 % of the time, though the catheter is not what its file says.
namespace palpate {
namespace {

constexpr int kRuns = 500;
constexpr std::size_t kFirst = 40;  // frames; a second

struct Covered {
  test::Coverage online, smoothed;
};

Covered cover(const Catheter& stated, const ObserverOptions& options, int runs) {
  test::Draws draws(7);
  Covered out;
  for (int run = 0; run < runs; ++run) {
    const test::Reality real = test::drawn_reality(stated, draws);
    const VirtualRecording recording =
        test::simulate(real, beating_wall_force, {.duration_s = 3.0, .seed = static_cast<std::uint64_t>(run) + 1});
    ForceObserver observer(stated, options);
    SmoothingPass pass(observer);
    for (std::size_t k = 0; k < recording.frames.size(); ++k) {
      const Estimate e = observer.update(recording.frames[k]);
      pass.add(observer, recording.frames[k], e);
      if (k >= kFirst) out.online.add(e.force_tip_N - recording.force_tip_N[k], e.covariance_tip_N2);
    }
    const std::vector<Estimate> smoothed = pass.finish(observer);
    for (std::size_t k = kFirst; k < smoothed.size(); ++k)
      out.smoothed.add(smoothed[k].force_tip_N - recording.force_tip_N[k], smoothed[k].covariance_tip_N2);
  }
  return out;
}

struct Layout {
  const char* name;
  bool stiffness, precurvature;
};

class HonestIntervals : public ::testing::TestWithParam<Layout> {
 protected:
  ObserverOptions options() const {
    return {.estimate_stiffness = GetParam().stiffness, .estimate_precurvature = GetParam().precurvature};
  }
};

/// Every run draws stiffness, precurvature, base and tracker bias anew from the sigmas of the file.
TEST_P(HonestIntervals, CoverTheTruth95PercentOfTheTime) {
  const Covered found = cover(test::uncertain_catheter(), options(), kRuns);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GE(found.online.percent()(axis), 93.0) << axis;
    EXPECT_LE(found.online.percent()(axis), 97.0) << axis;
    EXPECT_GE(found.smoothed.percent()(axis), 92.5) << axis;
    EXPECT_LE(found.smoothed.percent()(axis), 97.0) << axis;
  }
  std::cout << GetParam().name << ": covered " << found.online.percent().transpose() << " %, smoothed "
            << found.smoothed.percent().transpose() << " %\n";
}

/// The check can fail: the noise alone makes an interval that holds the truth a third of the time.
TEST_P(HonestIntervals, DoNotWithoutTheConsideredParameters) {
  ObserverOptions noise_alone = options();
  noise_alone.consider_uncertainty = false;
  const Covered found = cover(test::uncertain_catheter(), noise_alone, 50);
  EXPECT_LT(found.online.percent().tail<2>().maxCoeff(), 60.0);
  std::cout << GetParam().name << ", noise alone: covered " << found.online.percent().transpose() << " %\n";
}

INSTANTIATE_TEST_SUITE_P(Layout, HonestIntervals,
                         ::testing::Values(Layout{"force", false, false}, Layout{"stiffness", true, false},
                                           Layout{"precurvature", false, true}, Layout{"all", true, true}),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

/// A shaft without a bend, its tip pushed along its axis or not at all: nothing in the shape tells the axial force.
TEST(StraightShaft, AxialForceIsFlaggedAndItsSigmaHoldsTheTruth) {
  Catheter stated = test::two_sensors();
  stated.rod.sections[0].precurvature_per_m.setZero();
  constexpr double k99 = 2.575829;
  for (const double push_N : {0.0, -0.05}) {
    int flagged = 0, inside = 0, count = 0;
    for (unsigned run = 1; run <= 30; ++run) {
      const VirtualRecording recording =
          simulate_tracker(stated, test::constant_force({0.0, 0.0, push_N}), {.duration_s = 3.0, .seed = run});
      const std::vector<Estimate> estimates = test::run(stated, {}, recording.frames);
      for (std::size_t k = kFirst; k < estimates.size(); ++k) {
        const Estimate& e = estimates[k];
        const double error = std::abs(e.force_tip_N.z() - push_N);
        inside += error <= k99 * std::sqrt(e.covariance_tip_N2(2, 2));
        flagged += e.observability.axial_force_hidden && e.observability.shaft_straight;
        ++count;
      }
    }
    EXPECT_EQ(flagged, count) << push_N;
    EXPECT_GE(inside, 0.99 * count) << push_N;
  }
}

/// With a bend of 20 1/m the same force is told, and nothing is flagged.
TEST(StraightShaft, ABentOneIsNotFlagged) {
  Catheter stated = test::two_sensors();
  stated.rod.sections[0].precurvature_per_m = {20.0, 0.0, 0.0};
  const VirtualRecording recording =
      simulate_tracker(stated, test::constant_force({0.0, 0.0, -0.05}), {.duration_s = 3.0});
  for (const Estimate& e : test::run(stated, {}, recording.frames)) EXPECT_TRUE(e.observability.all_observable());
}

}  // namespace
}  // namespace palpate
