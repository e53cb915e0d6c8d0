// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <tests/observer/allocation_counter.hpp>
#include <tests/observer/layouts.hpp>
#include <tests/shared_recordings.hpp>

/// One update does a bounded amount of work and does not touch the heap, whatever it is shown.
namespace palpate {
namespace {

using test::Draws;

int most_evaluations(const Catheter& catheter, const ObserverOptions& options) {
  const UncertainParameters parameters = uncertain_parameters(catheter, options.parameters());
  return FrameExplainer::most_evaluations(options, static_cast<int>(catheter.sensors.size()), 3 + parameters.rod_count);
}

/// What the updates of one stream took.
struct Work {
  int most = 0, bound = 0;
  double mean = 0.0;
  std::size_t allocations = 0;

  Work(const Catheter& catheter, const ObserverOptions& options, const std::vector<TrackerFrame>& frames)
      : bound(most_evaluations(catheter, options)) {
    ForceObserver observer(catheter, options);
    for (const TrackerFrame& frame : frames) {
      const test::CountAllocations count;
      const Estimate e = observer.update(frame);
      allocations += count.so_far();
      most = std::max(most, e.evaluations);
      mean += static_cast<double>(e.evaluations) / static_cast<double>(frames.size());
    }
  }
  void judge(const std::string& what) const {
    fmt::print("{:<44} mean {:6.1f}, most {:4d} of {:4d} evaluations\n", what, mean, most, bound);
    EXPECT_LE(most, bound) << what;
    EXPECT_EQ(allocations, 0U) << what;
  }
};

constexpr int kFrames = 12;  // a stream

std::vector<TrackerFrame> numbered(std::vector<TrackerFrame> frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].number = static_cast<std::int64_t>(i);
    frames[i].time_s = 0.025 * static_cast<double>(i);
  }
  return frames;
}

/// Sensors anywhere within 0.2 m, turned in any way: no force explains them.
std::vector<TrackerFrame> random_poses(const Catheter& catheter, Draws& draws) {
  std::vector<TrackerFrame> frames(kFrames);
  for (TrackerFrame& frame : frames)
    for (const Sensor& sensor : catheter.sensors)
      frame.readings.push_back(test::reading_of(catheter.base.T_tracker_base * draws.pose(0.2), sensor.kind));
  return numbered(std::move(frames));
}

/// From one end of the ball of 0.4 N to the other and back: four times the buckling load, the shaft coils.
std::vector<TrackerFrame> far_apart_forces(const Catheter& catheter, Draws& draws) {
  std::vector<TrackerFrame> frames;
  for (int i = 0; i < kFrames; ++i) {
    const Vector3d force_N = (i % 2 == 0 ? 0.4 : -0.4) * draws.normal3().normalized();
    frames.push_back(test::with_noise(catheter, test::exact_frame(catheter, force_N), draws));
  }
  return numbered(std::move(frames));
}

/// One sensor in every frame is a few to a hundred millimetres off; the next frame another one.
std::vector<TrackerFrame> lone_outliers(const Catheter& catheter, Draws& draws) {
  std::vector<TrackerFrame> frames;
  for (int i = 0; i < kFrames; ++i) {
    frames.push_back(test::with_noise(catheter, test::exact_frame(catheter, draws.in_ball(0.1)), draws));
    const auto odd = static_cast<std::size_t>(i) % catheter.sensors.size();
    frames.back().readings[odd].position_m += draws.uniform(3e-3, 0.1) * draws.normal3().normalized();
  }
  return numbered(std::move(frames));
}

/// Jumps in which all sensors but one are somewhere else.
std::vector<TrackerFrame> one_good_sensor(const Catheter& catheter, Draws& draws) {
  std::vector<TrackerFrame> frames = far_apart_forces(catheter, draws);
  const std::vector<TrackerFrame> lies = random_poses(catheter, draws);
  for (std::size_t i = 0; i < frames.size(); ++i)
    for (std::size_t k = 0; k < catheter.sensors.size(); ++k)
      if (k != i % catheter.sensors.size()) frames[i].readings[k] = lies[i].readings[k];
  return frames;
}

struct Setup {
  const char* name;
  Catheter catheter;
};

std::vector<Setup> setups() {
  Catheter point = test::bare_catheter(), pose = point;
  point.sensors = {test::sensor_at("tip", 0.07, SensorKind::kPosition)};
  pose.sensors = {test::sensor_at("tip", 0.07)};
  return {{"point", point},
          {"one", pose},
          {"two", test::two_sensors()},
          {"mixed", test::mixed_sensors()},
          {"eight", test::eight_sensors()}};
}

class BoundedWork : public ::testing::TestWithParam<Method> {};

using Stream = std::vector<TrackerFrame> (*)(const Catheter&, Draws&);
constexpr std::pair<const char*, Stream> kStreams[] = {{"random poses", random_poses},
                                                       {"far-apart forces", far_apart_forces},
                                                       {"lone outliers", lone_outliers},
                                                       {"one good sensor", one_good_sensor}};

TEST_P(BoundedWork, InAdversarialStreams) {
  for (const MeasurementKind kind : {MeasurementKind::kPoses, MeasurementKind::kTipAndCurvature})
    for (const auto& [setup, catheter] : setups())
      for (const auto& [stream, make] : kStreams) {
        const bool raw = kind == MeasurementKind::kPoses;
        if (!raw && catheter.sensors[0].kind != SensorKind::kPose) continue;  // the paper's vector needs the tip's pose
        Draws draws(91);
        Work(catheter, {.method = GetParam(), .measurement = kind}, make(catheter, draws))
            .judge(fmt::format("{} {} {}: {}", test::name_of(GetParam()), raw ? "poses" : "curvature", setup, stream));
      }
}

/// Up to twelve states: every sigma stated, a tendon that is read now and then, a load that is known now and then, lag.
/// Two sensors in every layout; eight, whose updates take longest, in the largest. A few frames of each.
TEST_P(BoundedWork, InEveryLayout) {
  for (const test::Layout& layout : test::kEveryLayout)
    for (const auto& [stream, make] : {kStreams[0], kStreams[3]})
      for (const bool eight : {false, true}) {
        if (eight && std::string_view(layout.name) != "all") continue;
        const Catheter certain = eight ? test::eight_sensors() : test::two_sensors();
        const Catheter catheter = test::with_tendon(test::with_every_sigma(certain));
        Draws draws(93);
        std::vector<TrackerFrame> frames = make(catheter, draws);
        test::add_loads(catheter, frames);
        frames.resize(eight ? 2 : 6);  // the sixth knows the load
        ObserverOptions options = layout.of({.method = GetParam()});
        options.smoothing_lag_frames = 5;
        Work(catheter, options, frames)
            .judge(
                fmt::format("{} {} {}: {}", test::name_of(GetParam()), layout.name, eight ? "eight" : "two", stream));
      }
}

TEST_P(BoundedWork, InTheSharedRecordings) {
  PALPATE_NEEDS_SHARED(test::kRecordings);
  for (const char* name :
       {"weight_planar", "heartbeat", "faults", "stiffness_drift", "wrong_precurvature", "biased_tracker", "jumps"}) {
    test::SharedRecording recording = test::shared_recording(name);
    if (GetParam() != ObserverOptions{}.method) recording.frames.resize(400);  // ten seconds of the others
    Work(recording.catheter, {.method = GetParam()}, recording.frames)
        .judge(fmt::format("{} {}", test::name_of(GetParam()), name));
  }
}

/// More iterations are more work, and the stated bound says so.
TEST_P(BoundedWork, ForAnyNumberOfIterations) {
  for (const int iterations : {1, 5, 40, 100}) {
    Draws draws(92);
    const Catheter catheter = test::two_sensors();
    Work(catheter, {.method = GetParam(), .max_iterations = iterations}, one_good_sensor(catheter, draws))
        .judge(fmt::format("{} {} iterations", test::name_of(GetParam()), iterations));
  }
}

INSTANTIATE_TEST_SUITE_P(Method, BoundedWork, ::testing::ValuesIn(test::kEveryMethod),
                         [](const auto& test_case) { return std::string(test::name_of(test_case.param)); });

}  // namespace
}  // namespace palpate
