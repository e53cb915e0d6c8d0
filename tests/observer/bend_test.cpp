// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>
#include <palpate/observer/smoothing.hpp>
#include <tests/observer/allocation_counter.hpp>
#include <tests/observer/runs.hpp>

/// The observer while the handle moves: frames that say how far it bends the shaft.
namespace palpate {
namespace {

using Eigen::Vector2d;

constexpr double kRate_hz = 40.0;
const Vector2d kMapSigma_per_m(0.5, 0.2);

Catheter handled() {
  Catheter catheter = test::two_sensors();
  catheter.precurvature_sigma_per_m << kMapSigma_per_m, 0.0;
  return catheter;
}

/// From 30 to 50 1/m and back in 8 s.
Vector2d handle_at(double time_s) { return {40.0 - 10.0 * std::cos(2.0 * std::numbers::pi * time_s / 8.0), 2.0}; }

/// The shaft is bent by the handle, and by `error` more, which nobody knows. Each frame is a catheter of its own.
VirtualRecording record(const Catheter& catheter, const Vector2d& error, bool say, unsigned seed, int frames = 320) {
  VirtualRecording out;
  for (int i = 0; i < frames; ++i) {
    const double time_s = i / kRate_hz;
    Catheter now = catheter;
    now.rod.sections[0].precurvature_per_m.head<2>() = handle_at(time_s) + error;
    VirtualRecording one =
        simulate_tracker(now, [&](double) { return beating_wall_force(time_s); },
                         {.rate_hz = kRate_hz, .duration_s = 1.0 / kRate_hz, .seed = seed + 977 * i});
    TrackerFrame& frame = one.frames[0];
    frame.time_s = time_s;
    frame.number = i;
    const Vector2d change = handle_at(time_s) - catheter.precurvature_per_m().head<2>();
    if (say) frame.bend = {.present = true, .change_per_m = change, .sigma_per_m = kMapSigma_per_m};
    out.frames.push_back(std::move(frame));
    out.force_tip_N.push_back(one.force_tip_N[0]);
    out.force_base_N.push_back(one.force_base_N[0]);
  }
  return out;
}

double rmse(const std::vector<Estimate>& estimates, const VirtualRecording& recording) {
  double sum = 0.0;
  for (std::size_t i = 40; i < estimates.size(); ++i)
    sum += (estimates[i].force_tip_N - recording.force_tip_N[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(estimates.size() - 40));
}

TEST(Bend, MovingHandleIsFollowed) {
  const VirtualRecording told = record(handled(), {0.3, -0.1}, true, 1, 160),
                         silent = record(handled(), {0.3, -0.1}, false, 1, 160);
  const double with = rmse(test::run(handled(), {}, told.frames), told),
               without = rmse(test::run(handled(), {}, silent.frames), silent);
  std::printf("RMSE with the handle's bend %.4f N, with the fixed precurvature %.4f N\n", with, without);
  EXPECT_LT(with, 0.2 * without);
}

/// The shaft's error is drawn from the map's sigma once a run.
TEST(Bend, IntervalsCover) {
  test::Draws draws(17);
  int inside = 0, all = 0;
  for (unsigned run = 0; run < 40; ++run) {
    const Vector2d error = kMapSigma_per_m.cwiseProduct(Vector2d(draws.normal(), draws.normal()));
    const VirtualRecording recording = record(handled(), error, true, 100 * run, 80);
    const std::vector<Estimate> estimates = test::run(handled(), {}, recording.frames);
    for (std::size_t i = 40; i < estimates.size(); ++i)
      for (int axis = 0; axis < 3; ++axis, ++all)
        inside += std::abs(estimates[i].force_tip_N(axis) - recording.force_tip_N[i](axis)) <=
                  1.959964 * std::sqrt(estimates[i].covariance_tip_N2(axis, axis));
  }
  std::printf("95 %% intervals of the force cover %.1f %%\n", 100.0 * inside / all);
  EXPECT_GE(inside, 0.90 * all);
}

/// To the observer a bend is another catheter: same numbers to rounding, for every method and both measurements.
TEST(Bend, IsAsIfTheCatheterFileSaidSo) {
  Catheter bent = handled();
  bent.rod.sections[0].precurvature_per_m << 41.0, -3.0, 0.0;
  const VirtualRecording recording = simulate_tracker(bent, beating_wall_force, {.duration_s = 2.0, .seed = 4});
  std::vector<TrackerFrame> told = recording.frames;
  const Vector2d change = bent.precurvature_per_m().head<2>() - handled().precurvature_per_m().head<2>();
  for (TrackerFrame& frame : told)
    frame.bend = {.present = true, .change_per_m = change, .sigma_per_m = kMapSigma_per_m};
  for (const Method method : test::kEveryMethod)
    for (const MeasurementKind kind : {MeasurementKind::kPoses, MeasurementKind::kTipAndCurvature})
      for (const bool estimate : {false, true}) {
        ObserverOptions options{.method = method, .measurement = kind};
        options.estimate_precurvature = estimate;
        const std::vector<Estimate> a = test::run(handled(), options, told),
                                    b = test::run(bent, options, recording.frames);
        for (std::size_t i = 0; i < a.size(); ++i) {
          ASSERT_EQ(a[i].status, b[i].status) << test::name_of(method) << i;
          EXPECT_LT((a[i].force_tip_N - b[i].force_tip_N).norm(), 1e-6);
          EXPECT_LT((a[i].covariance_tip_N2 - b[i].covariance_tip_N2).norm(), 1e-8);
          EXPECT_LT((a[i].shaft.precurvature_per_m - b[i].shaft.precurvature_per_m).norm(), 1e-4);
        }
      }
}

/// The global search starts from the bent shaft, else it would read the handle as a force.
TEST(Bend, SearchStartsFromTheBentShaft) {
  Catheter bent = handled();
  bent.rod.sections[0].precurvature_per_m.x() = 55.0;
  for (const Vector3d& force_N : {Vector3d(0.0, 0.0, 0.0), Vector3d(0.05, 0.15, -0.1)}) {
    const TrackerFrame frame = test::exact_frame(bent, force_N);
    ShapeModel model(handled(), MeasurementKind::kPoses);
    Measurement measurement;
    register_frame(handled(), frame, measurement);
    model.select(measurement, 3U);
    model.set_bend({.present = true, .change_per_m = {25.0, 0.0}, .sigma_per_m = {0.01, 0.01}});
    StateVector x = StateVector::Zero(3);
    int evaluations = 0;
    ASSERT_TRUE(model.seed(0, x, evaluations));
    EXPECT_LT((x.head<3>() - force_N).norm(), 0.02) << x.transpose();
    ForceObserver observer(handled(), {});
    TrackerFrame told = frame;
    told.bend = {.present = true, .change_per_m = {25.0, 0.0}, .sigma_per_m = {0.01, 0.01}};
    EXPECT_LT((observer.update(told).force_tip_N - force_N).norm(), 0.01);
  }
}

/// The sigma of a frame's bend is that frame's: beyond the map it grows, and shrinks again. With one sensor, for two
/// would tell the bend by themselves.
TEST(Bend, SigmaOfTheFrameCounts) {
  Catheter catheter = handled();
  catheter.sensors.pop_back();
  const VirtualRecording recording = record(catheter, {0.0, 0.0}, true, 3, 200);
  std::vector<TrackerFrame> frames = recording.frames;
  for (std::size_t i = 100; i < 120; ++i) frames[i].bend.sigma_per_m *= 10.0;
  for (std::size_t i = 120; i < frames.size(); ++i) frames[i].bend.sigma_per_m.setZero();  // as the catheter says
  const std::vector<Estimate> plain = test::run(catheter, {}, recording.frames), wide = test::run(catheter, {}, frames);
  const auto sigma = [](const Estimate& e) { return std::sqrt(e.covariance_tip_N2.trace()); };
  EXPECT_GT(sigma(wide[115]), 1.3 * sigma(plain[115]));
  EXPECT_LT(sigma(wide[180]), 1.2 * sigma(plain[180]));
  EXPECT_EQ(sigma(wide[99]), sigma(plain[99]));
}

TEST(Bend, SmootherKnowsIt) {
  const VirtualRecording recording = record(handled(), {0.0, 0.0}, true, 5);
  ForceObserver observer(handled(), {});
  SmoothingPass pass(observer);
  std::vector<Estimate> online;
  for (const TrackerFrame& frame : recording.frames) {
    online.push_back(observer.update(frame));
    pass.add(observer, frame, online.back());
  }
  const std::vector<Estimate> smoothed = pass.finish(observer);
  EXPECT_LT(rmse(smoothed, recording), 1.05 * rmse(online, recording));
  for (std::size_t i = 40; i < smoothed.size(); i += 20) {
    EXPECT_LT((smoothed[i].R_base_tip - online[i].R_base_tip).norm(), 0.05);
    EXPECT_NEAR(smoothed[i].shaft.precurvature_per_m.x(), handle_at(recording.frames[i].time_s).x(), 1e-9);
  }
}

TEST(Bend, StepDoesNotAllocate) {
  const VirtualRecording recording = record(handled(), {0.0, 0.0}, true, 6);
  ForceObserver observer(handled(), {});
  observer.update(recording.frames[0]);
  const test::CountAllocations count;
  for (std::size_t i = 1; i < 200; ++i) observer.update(recording.frames[i]);
  EXPECT_EQ(count.so_far(), 0u);
}

}  // namespace
}  // namespace palpate
