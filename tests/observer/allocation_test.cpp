// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdlib>
#include <ostream>
#include <tests/observer/allocation_counter.hpp>
#include <tests/observer/layouts.hpp>

/// ForceObserver::update does not touch the heap, whatever the frame.
namespace palpate {
namespace {

using test::CountAllocations;

template <typename Action>
std::size_t allocations_of(const Action& action) {
  const CountAllocations count;
  action();
  return count.so_far();
}

TEST(CountAllocations, SeesNewMallocAndEigen) {
  EXPECT_EQ(allocations_of([] {}), 0U);
  int* volatile number = nullptr;
  EXPECT_GE(allocations_of([&] { number = new int(3); }), 1U);
  delete number;
  void* volatile block = nullptr;
  EXPECT_GE(allocations_of([&] { block = std::malloc(64); }), 1U);
  std::free(block);
  Eigen::VectorXd vector;
  EXPECT_GE(allocations_of([&] { vector.setZero(100); }), 1U);
}

struct Case {
  std::string name;
  Catheter catheter;
  ObserverOptions options;

  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
};

std::vector<Case> cases() {
  std::vector<Case> all;
  const std::pair<std::string, Catheter> setups[] = {
      {"two", test::two_sensors()},
      {"mixed", test::mixed_sensors()},
      {"eight", test::eight_sensors()},
      {"tracked_base", test::with_tracked_base(test::eight_sensors())},
      {"own_weight", test::with_own_weight(test::two_sensors())},
  };
  for (const Method method : test::kEveryMethod)
    for (const MeasurementKind kind : {MeasurementKind::kPoses, MeasurementKind::kTipAndCurvature})
      for (const auto& [name, catheter] : setups) {
        const bool raw = kind == MeasurementKind::kPoses;
        all.push_back({name + "_" + test::name_of(method) + (raw ? "_poses" : "_curvature"),
                       catheter,
                       {.method = method, .measurement = kind, .report_convergence_index = true}});
      }
  return all;
}

/// Everything uncertain, a tendon, episodes of known load, fixed lag: every number that a frame can bring.
std::vector<Case> layout_cases() {
  std::vector<Case> all;
  const std::pair<std::string, Catheter> setups[] = {
      {"two", test::two_sensors()},
      {"mixed", test::mixed_sensors()},
      {"eight", test::with_tracked_base(test::eight_sensors())},
  };
  for (const test::Filter& filter : test::every_filter())
    for (const auto& [name, catheter] : setups) {
      if (name == "eight" && std::string_view(filter.layout.name) != "all") continue;  // the largest of all is enough
      ObserverOptions options = filter.options();
      options.forecast_s = 0.1;
      options.smoothing_lag_frames = 12;
      options.report_convergence_index = true;
      const Catheter uncertain = test::with_tendon(test::with_every_sigma(catheter));
      all.push_back({name + "_" + filter.name() + "_poses", uncertain, options});
      options.measurement = MeasurementKind::kTipAndCurvature;
      if (name == "two") all.push_back({name + "_" + filter.name() + "_curvature", uncertain, options});
    }
  return all;
}

class NoAllocation : public ::testing::TestWithParam<Case> {};

/// Good frames, missing readings, outliers, a jump, frames without sensors, impossible times, a tendon moment,
/// where the catheter has a tendon known loads too.
TEST_P(NoAllocation, InAnyUpdate) {
  const auto& [name, catheter, options] = GetParam();
  auto jumping = [](double time_s) -> Vector3d {
    return time_s < 0.5 ? beating_wall_force(time_s) : Vector3d(0.02, -0.1, -0.08);
  };
  auto recording = simulate_tracker(catheter, jumping, {.duration_s = 1.0, .missing_share = 0.1, .outlier_share = 0.1});
  if (catheter.tendon.present) test::add_loads(catheter, recording.frames);
  for (SensorReading& reading : recording.frames[12].readings) reading = SensorReading{};
  recording.frames[20].time_s = -1.0;
  recording.frames[21].time_s = std::numeric_limits<double>::quiet_NaN();
  recording.frames[25].tendon = {.present = true, .moment_Nm = {1e-4, 0.0}, .sigma_Nm = 0.0};
  ForceObserver observer(catheter, options);
  std::array<std::size_t, kEstimateStatuses> seen{};
  for (const TrackerFrame& frame : recording.frames) {
    Estimate e;
    EXPECT_EQ(allocations_of([&] { e = observer.update(frame); }), 0U) << "frame " << frame.number;
    ++seen[static_cast<std::size_t>(e.status)];
  }
  EXPECT_GE(seen[static_cast<std::size_t>(EstimateStatus::kUpdated)] +
                seen[static_cast<std::size_t>(EstimateStatus::kReseeded)],
            20U);
  EXPECT_GE(seen[static_cast<std::size_t>(EstimateStatus::kHeld)], 1U);
  EXPECT_GE(seen[static_cast<std::size_t>(EstimateStatus::kRejected)], 2U);
}

INSTANTIATE_TEST_SUITE_P(Every, NoAllocation, ::testing::ValuesIn(cases()),
                         [](const auto& test_case) { return test_case.param.name; });
INSTANTIATE_TEST_SUITE_P(EveryLayout, NoAllocation, ::testing::ValuesIn(layout_cases()),
                         [](const auto& test_case) { return test_case.param.name; });

}  // namespace
}  // namespace palpate
