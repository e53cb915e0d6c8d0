// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <benchmarks/course.hpp>
#include <benchmarks/textbook_setup.hpp>
#include <palpate/estimation/kalman.hpp>

/// The yardstick and the bare update beside it: same catheter, same frames, same random walk, same noise. With the rows
/// of force_observer.cpp in one run they make the ratios that tools/benchmark.sh prints.
namespace palpate {
namespace {

void textbook_rod(benchmark::State& state) {
  const textbook::Shaft shaft = textbook::shaft_of(paper_catheter());
  Vector3d force_tip_N(0.03, 0.03, -0.1);
  for (auto _ : state) {
    force_tip_N.x() += 1e-9;
    benchmark::DoNotOptimize(textbook::solve_rod(shaft, force_tip_N));
  }
}
BENCHMARK(textbook_rod)->Name("textbook/rod");

template <int Rows, MeasurementKind kind>
void textbook_update(benchmark::State& state) {
  Course course(kind);
  const textbook::Shaft shaft = textbook::shaft_of(course.catheter);
  const auto information = textbook::noise_information<Rows>(course.model);
  textbook::Belief belief{Vector3d::Zero(), kWalk_N2};
  std::size_t next = 0;
  for (auto _ : state) {
    belief.covariance_N2 += kWalk_N2;
    belief = textbook::iekf_update<Rows>(shaft, belief, textbook::poses_of(course.frames[next]), information);
    benchmark::DoNotOptimize(belief);
    next = (next + 1) % course.frames.size();
  }
  state.counters["rods"] = textbook::kIterations * 7;
}
BENCHMARK(textbook_update<textbook::kPoseRows, MeasurementKind::kPoses>)->Name("textbook/update/poses");
BENCHMARK(textbook_update<textbook::kPaperRows, MeasurementKind::kTipAndCurvature>)
    ->Name("textbook/update/tip_and_curvature");

/// iterated_update() alone, converged to a hundredth of a sigma as the observer does it.
template <MeasurementKind kind>
void bare_update(benchmark::State& state) {
  Course course(kind);
  Gaussian belief{Vector3d::Zero(), kWalk_N2};
  Update update;
  std::size_t next = 0;
  std::int64_t evaluations = 0;
  for (auto _ : state) {
    belief.covariance += kWalk_N2;
    course.model.select(course.frames[next], ~0U);
    iterated_update(course.model, belief, belief.mean, {}, update);
    belief = update.posterior;
    benchmark::DoNotOptimize(belief);
    evaluations += update.evaluations;
    next = (next + 1) % course.frames.size();
  }
  state.counters["evals"] = benchmark::Counter(static_cast<double>(evaluations), benchmark::Counter::kAvgIterations);
}
BENCHMARK(bare_update<MeasurementKind::kPoses>)->Name("bare_update/iekf/poses");
BENCHMARK(bare_update<MeasurementKind::kTipAndCurvature>)->Name("bare_update/iekf/tip_and_curvature");

}  // namespace

}  // namespace palpate
