// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <palpate/observer/force_observer.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <random>
#include <string>

/// One rod solution, with and without sensitivities; one update of each filter under each law of motion, of a calm
/// force and of one that jumps; smoothing. On the paper's catheter.
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

/// Update after update over the recording, again and again; counts the evaluations of the model, mean and most.
void run_over(benchmark::State& state, VirtualRecording recording, const ObserverOptions& options) {
  ForceObserver observer(paper_catheter(), options);
  std::size_t next = 0;
  double time_s = 0.0;
  std::int64_t evaluations = 0;
  int most = 0;
  for (auto _ : state) {
    TrackerFrame& frame = recording.frames[next];
    frame.time_s = (time_s += 0.025);
    const Estimate estimate = observer.update(frame);
    benchmark::DoNotOptimize(estimate);
    evaluations += estimate.evaluations;
    most = std::max(most, estimate.evaluations);
    next = (next + 1) % recording.frames.size();
  }
  state.counters["evals"] = benchmark::Counter(static_cast<double>(evaluations), benchmark::Counter::kAvgIterations);
  state.counters["most"] = most;
}

void update(benchmark::State& state, const ObserverOptions& options) {
  run_over(state, simulate_tracker(paper_catheter(), beating_wall_force, {.rate_hz = 40.0, .duration_s = 10.0}),
           options);
}

/// A force that becomes another one between two frames, uniform in a ball of 0.3 N: the global search, every time.
void jump(benchmark::State& state, const ObserverOptions& options) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> side(-0.3, 0.3);
  const ForceSchedule anywhere = [&](double) {
    Vector3d force_N = Vector3d::Constant(1.0);
    while (force_N.norm() > 0.3) force_N = {side(engine), side(engine), side(engine)};
    return force_N;
  };
  run_over(state, simulate_tracker(paper_catheter(), anywhere, {.rate_hz = 40.0, .duration_s = 25.0}), options);
}

/// Rauch-Tung-Striebel over 10 s; the time is that of one frame.
void smooth_recording(benchmark::State& state, ForceMotion motion) {
  const Catheter catheter = paper_catheter();
  const VirtualRecording recording =
      simulate_tracker(catheter, beating_wall_force, {.rate_hz = 40.0, .duration_s = 10.0});
  ForceObserver observer(catheter, {.force_model = motion});
  RecordingSmoother smoother(observer.motion().model());
  for (const TrackerFrame& frame : recording.frames) {
    observer.update(frame);
    smoother.push(observer.motion().step(), observer.motion().state());
  }
  for (auto _ : state) benchmark::DoNotOptimize(smoother.smooth());
  const auto frames = static_cast<double>(state.iterations()) * static_cast<double>(recording.frames.size());
  state.counters["a frame"] = benchmark::Counter(frames, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

}  // namespace

void register_rows() {
  constexpr std::pair<const char*, Method> methods[] = {
      {"ekf", Method::kEkf}, {"iekf", Method::kIekf}, {"iaekf", Method::kIaekf}, {"ukf", Method::kUkf}};
  constexpr std::pair<const char*, MeasurementKind> kinds[] = {
      {"poses", MeasurementKind::kPoses}, {"tip_and_curvature", MeasurementKind::kTipAndCurvature}};
  constexpr std::pair<const char*, ForceMotion> laws[] = {{"random_walk", ForceMotion::kRandomWalk},
                                                          {"constant_velocity", ForceMotion::kConstantVelocity},
                                                          {"rhythm", ForceMotion::kRhythm}};
  const auto row = [](const std::string& name, auto&& run, const auto&... arguments) {
    benchmark::RegisterBenchmark(name.c_str(), run, arguments...);
  };
  for (const auto& [method, m] : methods)
    for (const auto& [kind, k] : kinds) {
      const std::string filter = std::string(method) + "/" + kind;
      for (const auto& [law, l] : laws)
        row("update/" + filter + "/" + law, update, ObserverOptions{.method = m, .measurement = k, .force_model = l});
      row("jump/" + filter, jump, ObserverOptions{.method = m, .measurement = k});
    }
  for (const auto& [law, l] : laws) {
    for (const int lag : {10, 40})
      row(std::string("update/iekf/poses/") + law + "/lag_" + std::to_string(lag), update,
          ObserverOptions{.force_model = l, .smoothing_lag_frames = lag});
    row(std::string("smooth/") + law, smooth_recording, l);
  }
}

}  // namespace palpate

int main(int argc, char** argv) {
  palpate::register_rows();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
