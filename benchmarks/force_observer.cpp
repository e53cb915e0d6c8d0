// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <benchmarks/paper_catheter.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/rod/instruction_set.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <random>
#include <string>

/// One rod solution, with and without sensitivities; one update of each filter under each law of motion, of a calm
/// force and of one that jumps; the same with more to estimate than the force, and with an uncertain catheter;
/// smoothing. On the paper's catheter.
namespace palpate {
namespace {

/// With a sigma for every number: 29 parameters beside the force, all of them considered where none is estimated.
Catheter uncertain_catheter() {
  Catheter catheter = paper_catheter();
  catheter.stiffness_sigma_fraction = 0.05;
  catheter.precurvature_sigma_per_m = {1.0, 1.0, 1.0};
  catheter.base.position_sigma_m = 0.3e-3;
  catheter.base.rotation_sigma_rad = 0.3 * kRadiansPerDegree;
  for (Sensor& sensor : catheter.sensors) {
    sensor.mount_sigma_m = 0.2e-3;
    sensor.bias_m = 0.48e-3;
    sensor.bias_rad = 0.3 * kRadiansPerDegree;
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
void run_over(benchmark::State& state, VirtualRecording recording, const Catheter& catheter,
              const ObserverOptions& options) {
  ForceObserver observer(catheter, options);
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

void update(benchmark::State& state, const Catheter& catheter, const ObserverOptions& options) {
  run_over(state, simulate_tracker(catheter, beating_wall_force, {.rate_hz = 40.0, .duration_s = 10.0}), catheter,
           options);
}

/// A force that becomes another one between two frames, uniform in a ball of 0.3 N: the global search, every time.
void jump(benchmark::State& state, const Catheter& catheter, const ObserverOptions& options) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> side(-0.3, 0.3);
  const ForceSchedule anywhere = [&](double) {
    Vector3d force_N = Vector3d::Constant(1.0);
    while (force_N.norm() > 0.3) force_N = {side(engine), side(engine), side(engine)};
    return force_N;
  };
  run_over(state, simulate_tracker(catheter, anywhere, {.rate_hz = 40.0, .duration_s = 25.0}), catheter, options);
}

/// Rauch-Tung-Striebel over 10 s; the time is that of one frame.
void smooth_recording(benchmark::State& state, ForceMotion motion) {
  const Catheter catheter = paper_catheter();
  const VirtualRecording recording =
      simulate_tracker(catheter, beating_wall_force, {.rate_hz = 40.0, .duration_s = 10.0});
  ForceObserver observer(catheter, {.force_model = motion});
  RecordingSmoother smoother(observer.motion().model(), observer.motion().parameters().prior());
  for (const TrackerFrame& frame : recording.frames) {
    observer.update(frame);
    smoother.push(observer.motion().step(), observer.motion().belief());
  }
  for (auto _ : state) benchmark::DoNotOptimize(smoother.smooth());
  const auto frames = static_cast<double>(state.iterations()) * static_cast<double>(recording.frames.size());
  state.counters["a frame"] = benchmark::Counter(frames, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

constexpr std::pair<const char*, Method> kMethods[] = {
    {"ekf", Method::kEkf}, {"iekf", Method::kIekf}, {"iaekf", Method::kIaekf}, {"ukf", Method::kUkf}};

void row(const std::string& name, auto&& run, const auto&... arguments) {
  benchmark::RegisterBenchmark(name.c_str(), run, arguments...);
}

/// Every method, measurement and law; the force alone, the catheter being exact.
void register_filters() {
  constexpr std::pair<const char*, MeasurementKind> kinds[] = {
      {"poses", MeasurementKind::kPoses}, {"tip_and_curvature", MeasurementKind::kTipAndCurvature}};
  constexpr std::pair<const char*, ForceMotion> laws[] = {{"random_walk", ForceMotion::kRandomWalk},
                                                          {"constant_velocity", ForceMotion::kConstantVelocity},
                                                          {"rhythm", ForceMotion::kRhythm}};
  const Catheter catheter = paper_catheter();
  for (const auto& [method, m] : kMethods)
    for (const auto& [kind, k] : kinds) {
      const std::string filter = std::string(method) + "/" + kind;
      for (const auto& [law, l] : laws)
        row("update/" + filter + "/" + law, update, catheter,
            ObserverOptions{.method = m, .measurement = k, .force_model = l});
      row("jump/" + filter, jump, catheter, ObserverOptions{.method = m, .measurement = k});
    }
  for (const auto& [law, l] : laws) {
    for (const int lag : {10, 40})
      row(std::string("update/iekf/poses/") + law + "/lag_" + std::to_string(lag), update, catheter,
          ObserverOptions{.force_model = l, .smoothing_lag_frames = lag});
    row(std::string("smooth/") + law, smooth_recording, l);
  }
}

/// What is estimated beside the force, with the catheter's other numbers exact and uncertain. "update/<method>/poses/
/// constant_velocity" is the force alone on an exact catheter.
void register_layouts() {
  struct Layout {
    const char* name;
    bool stiffness, free_torsion, precurvature;
  };
  constexpr Layout layouts[] = {{"force", false, false, false},
                                {"stiffness", true, false, false},
                                {"stiffness_free", true, true, false},
                                {"precurvature", false, false, true},
                                {"all", true, true, true}};
  const Catheter catheter = uncertain_catheter();
  for (const Layout& layout : layouts)
    for (const bool uncertain : {false, true})
      for (const auto& [method, m] : kMethods) {
        const ObserverOptions options{.method = m,
                                      .estimate_stiffness = layout.stiffness,
                                      .free_torsion = layout.free_torsion,
                                      .estimate_precurvature = layout.precurvature,
                                      .consider_uncertainty = uncertain};
        const std::string filter = std::string(method) + "/poses";
        const std::string kind = std::string("/") + layout.name + (uncertain ? "/uncertain" : "/exact");
        row("update/" + filter + "/constant_velocity" + kind, update, catheter, options);
        row("jump/" + filter + kind, jump, catheter, options);
      }
}

}  // namespace

void register_rows() {
  register_filters();
  register_layouts();
}

}  // namespace palpate

/// The environment's PALPATE_INSTRUCTION_SET chooses the rod's kernel; the output says which it was.
int main(int argc, char** argv) {
  benchmark::AddCustomContext("instruction_set", palpate::name(palpate::preferred_instruction_set()));
  palpate::register_rows();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
