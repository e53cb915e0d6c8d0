// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <palpate/batch/batch.hpp>
#include <palpate/batch/plan.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/rod/reach.hpp>
#include <palpate/rod/step_rule.hpp>
#include <vector>

namespace palpate {
namespace {

using rod_lanes::kBlock;
using rod_lanes::Point;
using rod_lanes::Row;

/// Rods of one task: enough to find lanes of like step counts in, few enough to stay in the core's cache.
constexpr std::size_t kChunk = 512;

struct NamedSpan {
  const char* name;
  std::span<const Vector3d> values;
};

std::array<NamedSpan, 6> named(const BatchLoads& loads) {
  return {{{"force_tip_N", loads.force_tip_N},
           {"moment_tip_Nm", loads.moment_tip_Nm},
           {"tendon_couple_Nm", loads.tendon_couple_Nm},
           {"distributed_tip_N_per_m", loads.distributed_tip_N_per_m},
           {"log_stiffness", loads.log_stiffness},
           {"precurvature_per_m", loads.precurvature_per_m}}};
}

std::size_t rods_of(const BatchLoads& loads) {
  NamedSpan first{};
  for (const NamedSpan& span : named(loads)) {
    if (span.values.empty()) continue;
    if (first.values.empty()) first = span;
    if (span.values.size() != first.values.size())
      throw InputError(fmt::format("{}: {} loads, expected {} as of {}, or none", span.name, span.values.size(),
                                   first.values.size(), first.name));
  }
  return first.values.size();
}

Vector3d entry(std::span<const Vector3d> values, std::size_t i) {
  return values.empty() ? Vector3d::Zero() : values[i];
}

TipLoad load_of(const BatchLoads& loads, std::size_t i) {
  return {.force_tip_N = entry(loads.force_tip_N, i),
          .moment_tip_Nm = entry(loads.moment_tip_Nm, i),
          .tendon_couple_Nm = entry(loads.tendon_couple_Nm, i),
          .distributed_tip_N_per_m = entry(loads.distributed_tip_N_per_m, i),
          .log_stiffness = entry(loads.log_stiffness, i),
          .precurvature_per_m = entry(loads.precurvature_per_m, i)};
}

void resize(BatchPoints& points, Eigen::Index rods, bool sensitivities) {
  points.R_base_local.resize(9, rods);
  points.p_base_local_m.resize(3, rods);
  points.curvature_per_m.resize(3, rods);
  const Eigen::Index tangents = sensitivities ? rods : 0;
  points.d_rotation.resize(9, tangents);
  points.d_position_m.resize(9, tangents);
  points.d_curvature_per_m.resize(9, tangents);
}

template <class Matrix>
void scatter(const Row* rows, std::span<const int> rods, std::size_t first, Matrix& out) {
  for (Eigen::Index r = 0; r < out.rows(); ++r)
    for (std::size_t lane = 0; lane < rods.size(); ++lane)
      out(r, static_cast<Eigen::Index>(first) + rods[lane]) = rows[r][lane];
}

void scatter(const Point& point, std::span<const int> rods, std::size_t first, bool sensitivities, BatchPoints& out) {
  scatter(point.R, rods, first, out.R_base_local);
  scatter(point.p_m, rods, first, out.p_base_local_m);
  scatter(point.curvature_per_m, rods, first, out.curvature_per_m);
  if (!sensitivities) return;
  scatter(point.d_rotation, rods, first, out.d_rotation);
  scatter(point.d_position_m, rods, first, out.d_position_m);
  scatter(point.d_curvature_per_m, rods, first, out.d_curvature_per_m);
}

rod_lanes::Kernel* kernel(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return rod_lanes::solve_avx512;
  if (set == InstructionSet::kAvx2) return rod_lanes::solve_avx2;
#endif
  (void)set;
  return rod_lanes::solve_baseline;
}

/// A worker's own.
struct Scratch {
  std::vector<double> curvature_per_m = std::vector<double>(kChunk);
  std::vector<int> steps = std::vector<int>(kChunk), order = std::vector<int>(kChunk), bins;
  rod_lanes::Loads loads;
  std::vector<std::array<double, kBlock>> piece_steps;
  std::vector<Point> points;
};

/// All that the tasks share.
struct Batch {
  const RodSolver& solver;
  const BatchLoads& loads;
  rod_lanes::SolverPlan plan;
  rod_lanes::Kind kind;
  rod_lanes::Kernel* kernel;
  std::size_t rods;
  BatchSolution& solution;

  void solve_chunk(std::size_t first, Scratch& scratch) const;
  void sort_by_steps(std::size_t first, int rods_here, Scratch& scratch) const;
  void solve_block(std::size_t first, std::span<const int> rods_here, Scratch& scratch) const;
};

/// Counting sort of a chunk. Step counts of all pieces grow with one number, so equal sums are equal counts, but for a
/// short piece at the tip.
void Batch::sort_by_steps(std::size_t first, int rods_here, Scratch& scratch) const {
  scratch.bins.assign(static_cast<std::size_t>(plan.plan().piece_count * rod_lanes::kMostSteps) + 2, 0);
  for (int i = 0; i < rods_here; ++i) {
    scratch.curvature_per_m[i] = solver.curvature_bound_per_m(load_of(loads, first + i));
    solution.within_reach[first + i] = within_reach(solver, scratch.curvature_per_m[i]) ? 1 : 0;
    scratch.steps[i] = rod_lanes::total_steps(plan.plan(), solver.step_rule(), scratch.curvature_per_m[i]);
    ++scratch.bins[scratch.steps[i] + 1];
  }
  for (std::size_t k = 1; k < scratch.bins.size(); ++k) scratch.bins[k] += scratch.bins[k - 1];
  for (int i = 0; i < rods_here; ++i) scratch.order[scratch.bins[scratch.steps[i]]++] = i;
}

/// Lanes without a rod of their own repeat the last one.
void Batch::solve_block(std::size_t first, std::span<const int> rods_here, Scratch& scratch) const {
  const int lanes = static_cast<int>(rods_here.size());
  Row* steps = reinterpret_cast<Row*>(scratch.piece_steps.data());
  for (int lane = 0; lane < kBlock; ++lane) {
    const int rod = rods_here[std::min(lane, lanes - 1)];
    rod_lanes::set_lane(solver, load_of(loads, first + rod), lane, scratch.loads);
    rod_lanes::step_counts(plan.plan(), solver.step_rule(), scratch.curvature_per_m[rod], lane, steps);
  }
  kernel(plan.plan(), kind, scratch.loads, steps, lanes, scratch.points.data());
  scatter(scratch.points[0], rods_here, first, kind.sensitivities, solution.tip);
  for (std::size_t k = 1; k < scratch.points.size(); ++k)
    scatter(scratch.points[k], rods_here, first, kind.sensitivities, solution.stations[solver.station_order()[k - 1]]);
}

void Batch::solve_chunk(std::size_t first, Scratch& scratch) const {
  const int rods_here = static_cast<int>(std::min(kChunk, rods - first));
  scratch.piece_steps.resize(plan.plan().piece_count);
  scratch.points.resize(plan.plan().point_count);
  sort_by_steps(first, rods_here, scratch);
  for (int k = 0; k < rods_here; k += kBlock)
    solve_block(first, std::span(scratch.order).subspan(k, std::min(kBlock, rods_here - k)), scratch);
}

}  // namespace

void BatchOptions::validate() const {
  if (workers < 0)
    throw InputError(fmt::format("workers {}: expected a positive number, or 0 for one a core", workers));
  if (!available(instructions))
    throw InputError(fmt::format("instruction set {}: this processor lacks it, expected at most {}", name(instructions),
                                 name(widest_instruction_set())));
}

void solve_batch(const RodSolver& solver, const BatchLoads& loads, const BatchOptions& options,
                 BatchSolution& solution) {
  options.validate();
  const std::size_t rods = rods_of(loads);
  solution.stations.resize(solver.arc_lengths_m().size());
  solution.within_reach.resize(rods);
  resize(solution.tip, static_cast<Eigen::Index>(rods), options.force_sensitivities);
  for (BatchPoints& station : solution.stations)
    resize(station, static_cast<Eigen::Index>(rods), options.force_sensitivities);

  const bool full = solver.rod().shears() || !loads.distributed_tip_N_per_m.empty();
  const Batch batch{
      solver, loads,   rod_lanes::SolverPlan(solver), {full, options.force_sensitivities}, kernel(options.instructions),
      rods,   solution};
  tbb::enumerable_thread_specific<Scratch> scratch;
  const auto solve_chunk = [&](std::size_t chunk) { batch.solve_chunk(chunk * kChunk, scratch.local()); };
  const std::size_t chunks = (rods + kChunk - 1) / kChunk;
  if (options.workers == 1 || chunks < 2) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) solve_chunk(chunk);
    return;
  }
  tbb::task_arena arena(options.workers == 0 ? tbb::task_arena::automatic : options.workers);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, chunks, solve_chunk); });
}

}  // namespace palpate
