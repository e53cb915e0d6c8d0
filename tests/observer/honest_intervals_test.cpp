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

/// A shaft with hardly a bend, exactly as its file says or not, loaded in some way.
struct StraightCase {
  const char* name;
  double k1_per_m;
  bool uncertain;
  ForceSchedule force;

  friend void PrintTo(const StraightCase& shown, std::ostream* out) { *out << shown.name; }
};

class StraightShaft : public ::testing::TestWithParam<StraightCase> {
 protected:
  static Catheter stated() {
    Catheter catheter = GetParam().uncertain ? test::uncertain_catheter() : test::two_sensors();
    catheter.rod.sections[0].precurvature_per_m = {GetParam().k1_per_m, 0.0, 0.0};
    if (GetParam().uncertain) catheter.precurvature_sigma_per_m = {0.6, 0.6, 0.2};
    return catheter;
  }
};

ForceSchedule turning(double lateral_N, double axial_N) {
  return [=](double t) { return Vector3d(lateral_N * std::sin(t), lateral_N * std::cos(t), axial_N); };
}

/// Where the shape hardly tells the axial force, its interval is as wide as what is not known of it.
TEST_P(StraightShaft, TheAxialIntervalHoldsTheTruth) {
  constexpr double k99 = 2.575829;
  const Catheter catheter = stated();
  test::Draws draws(3);
  int flagged = 0, inside = 0, count = 0;
  for (unsigned run = 1; run <= 20; ++run) {
    const VirtualRecording recording =
        test::simulate(test::drawn_reality(catheter, draws), GetParam().force, {.duration_s = 3.0, .seed = run});
    const std::vector<Estimate> estimates = test::run(catheter, {}, recording.frames);
    for (std::size_t k = kFirst; k < estimates.size(); ++k) {
      const Estimate& e = estimates[k];
      inside +=
          std::abs(e.force_tip_N.z() - recording.force_tip_N[k].z()) <= k99 * std::sqrt(e.covariance_tip_N2(2, 2));
      flagged += e.observability.axial_force_hidden;
      ++count;
    }
  }
  EXPECT_GE(inside, 0.99 * count);
  EXPECT_GE(flagged, 0.9 * count);
  std::cout << GetParam().name << ": inside " << 100.0 * inside / count << " %, flagged " << 100.0 * flagged / count
            << " %\n";
}

INSTANTIATE_TEST_SUITE_P(Load, StraightShaft,
                         ::testing::Values(StraightCase{"free", 0.0, false, turning(0.0, 0.0)},
                                           StraightCase{"pushed", 0.0, false, turning(0.0, -0.05)},
                                           StraightCase{"sideways", 0.0, false, turning(0.01, -0.03)},
                                           StraightCase{"wall", 0.0, false, beating_wall_force},
                                           StraightCase{"bent_a_little", 4.0, false, turning(0.0, -0.05)},
                                           StraightCase{"uncertain_free", 0.0, true, turning(0.0, 0.0)},
                                           StraightCase{"uncertain_sideways", 0.0, true, turning(0.03, -0.05)},
                                           StraightCase{"uncertain_wall", 0.0, true, beating_wall_force},
                                           StraightCase{"uncertain_bent_a_little", 3.0, true, turning(0.03, -0.05)}),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

/// With a bend of 20 1/m the same force is told, and nothing is flagged.
TEST(BentShaft, NothingIsFlagged) {
  Catheter stated = test::two_sensors();
  stated.rod.sections[0].precurvature_per_m = {20.0, 0.0, 0.0};
  const VirtualRecording recording =
      simulate_tracker(stated, test::constant_force({0.0, 0.0, -0.05}), {.duration_s = 3.0});
  for (const Estimate& e : test::run(stated, {}, recording.frames)) EXPECT_TRUE(e.observability.all_observable());
}

}  // namespace
}  // namespace palpate
