// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <array>
#include <palpate/observer/force_observer.hpp>
#include <palpate/simulation/virtual_tracker.hpp>

/// One rod solution, with and without sensitivities, and one update of each filter, on the paper's catheter.
namespace palpate {
namespace {

Catheter paper_catheter() {
  Catheter catheter;
  catheter.name = "paper, Table 2";
  catheter.rod = uniform_rod(0.07, {0.2612e-3, 0.16664e-3, 0.1645e-3}, {24.57, 0.0, 0.0});
  for (const auto& [name, arc_length_m] : {std::pair{"tip", 0.07}, std::pair{"shaft", 0.0653}}) {
    Sensor sensor;
    sensor.name = name;
    sensor.arc_length_m = arc_length_m;
    catheter.sensors.push_back(sensor);
  }
  return catheter;
}

template <int N>
LoadDirections<N> directions() {
  LoadDirections<N> d;
  if constexpr (N >= 3) d.force_tip_N.template leftCols<3>().setIdentity();
  if constexpr (N >= 12) {
    d.moment_tip_Nm.template middleCols<3>(3).setIdentity();
    d.log_stiffness.template middleCols<3>(6).setIdentity();
    d.precurvature_per_m.template middleCols<3>(9).setIdentity();
  }
  return d;
}

/// N = 0: shape alone; 3: with the derivatives to the force; 12: to force, moment, stiffness and precurvature.
template <int N, Accuracy accuracy>
void rod_solve(benchmark::State& state) {
  constexpr std::array stations{0.07, 0.0653};
  const RodSolver solver(paper_catheter().rod, stations, accuracy);
  const LoadDirections<N> d = directions<N>();
  RodSolution<N> solution = solver.template make_solution<N>();
  TipLoad load{.force_tip_N = {0.03, 0.03, -0.1}};
  for (auto _ : state) {
    load.force_tip_N.x() += 1e-9;
    solver.solve(load, d, solution);
    benchmark::DoNotOptimize(solution.points.front());
  }
}
BENCHMARK(rod_solve<0, Accuracy::kRealtime>)->Name("rod/value");
BENCHMARK(rod_solve<3, Accuracy::kRealtime>)->Name("rod/value+3_sensitivities");
BENCHMARK(rod_solve<12, Accuracy::kRealtime>)->Name("rod/value+12_sensitivities");
BENCHMARK(rod_solve<0, Accuracy::kReference>)->Name("rod/value/reference");
BENCHMARK(rod_solve<3, Accuracy::kReference>)->Name("rod/value+3_sensitivities/reference");

void observer_update(benchmark::State& state, Method method, MeasurementKind measurement) {
  const Catheter catheter = paper_catheter();
  VirtualRecording recording = simulate_tracker(catheter, beating_wall_force, {.rate_hz = 40.0, .duration_s = 10.0});
  ForceObserver observer(catheter, {.method = method, .measurement = measurement});
  std::size_t next = 0;
  std::int64_t evaluations = 0;
  double time_s = 0.0;
  for (auto _ : state) {
    TrackerFrame& frame = recording.frames[next];
    frame.time_s = (time_s += 0.025);
    const Estimate estimate = observer.update(frame);
    benchmark::DoNotOptimize(estimate);
    evaluations += estimate.evaluations;
    next = (next + 1) % recording.frames.size();
  }
  state.counters["rod solutions"] =
      benchmark::Counter(static_cast<double>(evaluations), benchmark::Counter::kAvgIterations);
}
BENCHMARK_CAPTURE(observer_update, ekf, Method::kEkf, MeasurementKind::kPoses);
BENCHMARK_CAPTURE(observer_update, iekf, Method::kIekf, MeasurementKind::kPoses);
BENCHMARK_CAPTURE(observer_update, iaekf, Method::kIaekf, MeasurementKind::kPoses);
BENCHMARK_CAPTURE(observer_update, ekf_tip_and_curvature, Method::kEkf, MeasurementKind::kTipAndCurvature);
BENCHMARK_CAPTURE(observer_update, iekf_tip_and_curvature, Method::kIekf, MeasurementKind::kTipAndCurvature);
BENCHMARK_CAPTURE(observer_update, iaekf_tip_and_curvature, Method::kIaekf, MeasurementKind::kTipAndCurvature);

}  // namespace
}  // namespace palpate

BENCHMARK_MAIN();
