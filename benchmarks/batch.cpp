// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <palpate/batch/batch.hpp>
#include <random>
#include <string>
#include <vector>

/// Many rods: RodSolver one by one against solve_batch, for each instruction set, and one worker against two. Both of a
/// pair are timed in turn and compared by their medians, so that what else the machine does meets both alike.
///   ns_a_rod: of the batch; times_scalar, speed_up: the ratios; rods_per_s: of the batch
namespace palpate {
namespace {

constexpr int kRods = 4096;

/// The paper's catheter under forces uniform in a 0.4 N ball, as in docs/theory/integrators.md.
struct Case {
  RodSolver solver;
  std::vector<Vector3d> force_N;
};

Case paper_case(std::span<const double> stations_m, int rods) {
  std::mt19937_64 random(20260101);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit;
  Case c{RodSolver(uniform_rod(0.07, {0.2612e-3, 0.16664e-3, 0.1645e-3}, {24.57, 0.0, 0.0}), stations_m), {}};
  for (int i = 0; i < rods; ++i) {
    const Vector3d v(normal(random), normal(random), normal(random));
    c.force_N.push_back(0.4 * std::cbrt(unit(random)) * v.normalized());
  }
  return c;
}

/// Of this thread: what others do on the machine does not count.
double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

template <class Run>
double seconds_of(double (*clock)(), const Run& run) {
  const double start = clock();
  run();
  return clock() - start;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <int N>
void solve_one_by_one(const Case& c, RodSolution<N>& solution) {
  LoadDirections<N> directions;
  if constexpr (N > 0) directions.force_tip_N.setIdentity();
  for (const Vector3d& force_N : c.force_N) {
    c.solver.solve({.force_tip_N = force_N}, directions, solution);
    benchmark::DoNotOptimize(solution.T_base_tip);
  }
}

/// N = 0: values; 3: with the derivatives to the force.
template <int N>
void against_scalar(benchmark::State& state, const Case& c, InstructionSet set) {
  RodSolution<N> one = c.solver.make_solution<N>();
  BatchSolution batch;
  const BatchOptions options{.force_sensitivities = N > 0, .workers = 1, .instructions = set};
  std::vector<double> scalar_s, batch_s;
  for (auto _ : state) {
    scalar_s.push_back(seconds_of(thread_seconds, [&] { solve_one_by_one<N>(c, one); }));
    batch_s.push_back(
        seconds_of(thread_seconds, [&] { solve_batch(c.solver, {.force_tip_N = c.force_N}, options, batch); }));
    state.SetIterationTime(batch_s.back());
  }
  const auto rods = static_cast<double>(c.force_N.size());
  state.counters["scalar_ns_a_rod"] = 1e9 * median(scalar_s) / rods;
  state.counters["ns_a_rod"] = 1e9 * median(batch_s) / rods;
  state.counters["rods_per_s"] = rods / median(batch_s);
  state.counters["times_scalar"] = median(scalar_s) / median(batch_s);
  state.SetLabel(name(set));
}

/// One worker and two in turn, by the wall clock: only an otherwise idle machine shows what two cores give.
void two_workers(benchmark::State& state, const Case& c) {
  BatchSolution batch;
  std::vector<double> one_s, two_s;
  const auto solve = [&](int workers) {
    return seconds_of(wall_seconds,
                      [&] { solve_batch(c.solver, {.force_tip_N = c.force_N}, {.workers = workers}, batch); });
  };
  for (auto _ : state) {
    one_s.push_back(solve(1));
    two_s.push_back(solve(2));
    state.SetIterationTime(two_s.back());
  }
  const auto rods = static_cast<double>(c.force_N.size());
  state.counters["ns_a_rod"] = 1e9 * median(two_s) / rods;
  state.counters["rods_per_s"] = rods / median(two_s);
  state.counters["speed_up"] = median(one_s) / median(two_s);
  state.counters["best_speed_up"] = *std::ranges::min_element(one_s) / *std::ranges::min_element(two_s);
  state.SetLabel(name(widest_instruction_set()));
}

void register_all() {
  constexpr std::array kStations_m{0.07, 0.0653};
  const Case tip = paper_case({}, kRods), sensors = paper_case(kStations_m, kRods);
  for (const InstructionSet set : kInstructionSets) {
    if (!available(set)) continue;
    const auto row = [&](const std::string& what, auto&& run, const Case& c) {
      benchmark::RegisterBenchmark((what + "/" + name(set)).c_str(), run, c, set)->UseManualTime()->MinTime(0.1);
    };
    row("batch/tip", against_scalar<0>, tip);
    row("batch/tip+3_sensitivities", against_scalar<3>, tip);
    row("batch/two_sensors", against_scalar<0>, sensors);
    row("batch/two_sensors+3_sensitivities", against_scalar<3>, sensors);
  }
  benchmark::RegisterBenchmark("batch/two_workers", two_workers, paper_case({}, 40 * kRods))
      ->UseManualTime()
      ->MinTime(1.0);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  benchmark::AddCustomContext("instruction set", palpate::name(palpate::widest_instruction_set()));
  palpate::register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
