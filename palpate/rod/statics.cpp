// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <palpate/math/errors.hpp>
#include <palpate/rod/integration.hpp>
#include <palpate/rod/statics.hpp>
#include <palpate/rod/step_rule.hpp>

namespace palpate {

namespace {

// Measured by benchmarks/integrators: the largest angles of a step of order 8 that keep the promised accuracy, with a
// margin of two. The short piece at the tip adds a hundredth of it (docs/theory/integrators.md).
constexpr rod_lanes::StepRule kRealtimeSteps{.angle = 1.25, .short_angle = 0.45};
constexpr rod_lanes::StepRule kReferenceSteps{.angle = 0.65, .short_angle = 0.0};

std::vector<double> stops_from_tip(const Rod& rod, std::span<const double> arc_lengths_m) {
  const double length = rod.length_m();
  std::vector<double> stops{length};
  for (const Section& section : rod.sections) stops.push_back(length - section.from_m);
  for (const double s : arc_lengths_m)
    if (s < length) stops.push_back(length - s);
  std::sort(stops.begin(), stops.end());
  const auto same = [length](double a, double b) { return b - a < 1e-12 * length; };
  stops.erase(std::unique(stops.begin(), stops.end(), same), stops.end());
  std::erase_if(stops, [length](double sigma) { return sigma < 1e-12 * length; });
  return stops;
}

rod_lanes::MarchKernel* kernel_of(InstructionSet set) {
  if (!available(set)) throw InputError(fmt::format("instructions {}: this processor lacks them", name(set)));
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512) return rod_lanes::march_avx512;
  if (set == InstructionSet::kAvx2) return rod_lanes::march_avx2;
#endif
  return rod_lanes::march_baseline;
}

int section_at(const Rod& rod, double s) {
  int index = 0;
  while (index + 1 < static_cast<int>(rod.sections.size()) && s >= rod.sections[index].to_m) ++index;
  return index;
}

}  // namespace

RodSolver::RodSolver(Rod rod, std::span<const double> arc_lengths_m, Accuracy accuracy, InstructionSet instructions)
    : rod_(std::move(rod)),
      arc_lengths_m_(arc_lengths_m.begin(), arc_lengths_m.end()),
      station_order_(arc_lengths_m.size()),
      step_rule_(accuracy == Accuracy::kRealtime ? kRealtimeSteps : kReferenceSteps),
      kernel_(kernel_of(instructions)) {
  rod_.validate();
  const double length = rod_.length_m(), reach = length + rod_.rigid_tip_m, slack = 1e-9 * length;
  for (const double s : arc_lengths_m_)
    if (!(s >= -slack && s <= reach + slack))
      throw InputError(fmt::format("arc length {} m: expected a place on the shaft, 0 to {} m", s, reach));

  std::iota(station_order_.begin(), station_order_.end(), 0);
  std::stable_sort(station_order_.begin(), station_order_.end(),
                   [&](int a, int b) { return arc_lengths_m_[a] > arc_lengths_m_[b]; });
  const auto sigma_of = [&](int k) { return length - arc_lengths_m_[station_order_[k]]; };
  const int stations = static_cast<int>(station_order_.size());
  while (stations_at_tip_ < stations && sigma_of(stations_at_tip_) < 1e-12 * length) ++stations_at_tip_;

  double from = 0.0;
  int next = stations_at_tip_;
  for (const double sigma : stops_from_tip(rod_, arc_lengths_m_)) {
    Piece piece{.from_sigma_m = from, .length_m = sigma - from, .first_station = next};
    piece.section = section_at(rod_, length - 0.5 * (from + sigma));
    while (next < stations && sigma_of(next) < sigma + 1e-12 * length) ++next;
    piece.end_station = next;
    pieces_.push_back(piece);
    from = sigma;
  }

  least_stiffness_Nm2_.setConstant(std::numeric_limits<double>::infinity());
  for (const Section& section : rod_.sections)
    if (!section.rigid) least_stiffness_Nm2_ = least_stiffness_Nm2_.cwiseMin(section.stiffness_Nm2);
}

double RodSolver::curvature_bound_per_m(const TipLoad& load) const {
  const Vector3d moment = load.moment_tip_Nm + rod_.contact_offset_m.cross(load.force_tip_N);
  const double force = load.force_tip_N.norm() + rod_.length_m() * load.distributed_tip_N_per_m.norm();
  const double least_stiffness_Nm2 = least_stiffness_Nm2_.cwiseQuotient(compliance_factor(load)).minCoeff();
  double unloaded = 0.0;
  for (const Section& section : rod_.sections)
    unloaded = std::max(unloaded, rod_lanes::unloaded_curvature(section, load).norm());
  return unloaded + (moment.norm() + load.tendon_couple_Nm.norm()) / least_stiffness_Nm2 +
         2.0 * std::sqrt(force / least_stiffness_Nm2);
}

template <int N>
RodSolution<N> RodSolver::make_solution() const {
  RodSolution<N> solution;
  solution.points.resize(arc_lengths_m_.size());
  if constexpr (N > 0) solution.tangents.resize(arc_lengths_m_.size());
  return solution;
}

template <int N>
void RodSolver::solve(const TipLoad& load, const LoadDirections<N>& directions, RodSolution<N>& solution) const {
  using namespace rod_lanes;
  assert(solution.points.size() == arc_lengths_m_.size());
  const bool full =
      rod_.shears() || !load.distributed_tip_N_per_m.isZero(0.0) || !directions.distributed_tip_N_per_m.isZero(0.0);
  const double curvature_per_m = curvature_bound_per_m(load);
  MarchState state;
  MarchField field;
  MarchRecord at_tip, record;
  set_tip<N>(state);
  set_load(rod_, load, directions, field);
  const Section* section = nullptr;
  for (const Piece& piece : pieces_) {
    const Section* next = &rod_.sections[piece.section];
    if (section != next) set_section(rod_, *next, load, directions, field);
    section = next;
    const bool first = piece.from_sigma_m == 0.0, stations = piece.first_station < piece.end_station;
    kernel_({piece.from_sigma_m, piece.length_m, steps_over(piece.length_m * curvature_per_m, first, step_rule_)}, full,
            N + 1, field, state, first ? &at_tip : nullptr, stations ? &record : nullptr);
    if (first) keep_tip(at_tip, full, load, directions, solution);
    for (int k = piece.first_station; k < piece.end_station; ++k)
      keep(state, record, full, load, directions, station_order_[k], solution);
  }
  to_base_frame(state, solution);
}

/// Stations at the flexible end, and on the rigid tip beyond.
template <int N>
void RodSolver::keep_tip(const rod_lanes::MarchRecord& record, bool full, const TipLoad& load,
                         const LoadDirections<N>& directions, RodSolution<N>& solution) const {
  if (stations_at_tip_ == 0) return;
  rod_lanes::MarchState tip;
  rod_lanes::set_tip<N>(tip);
  for (int k = 0; k < stations_at_tip_; ++k) {
    const int station = station_order_[k];
    rod_lanes::keep(tip, record, full, load, directions, station, solution);
    const double beyond_m = arc_lengths_m_[station] - rod_.length_m();
    if (beyond_m >= 1e-12 * rod_.length_m()) rod_lanes::onto_rigid_tip(beyond_m, load, directions, station, solution);
  }
}

#define PALPATE_INSTANTIATE(N)                                 \
  template RodSolution<N> RodSolver::make_solution<N>() const; \
  template void RodSolver::solve<N>(const TipLoad&, const LoadDirections<N>&, RodSolution<N>&) const;
PALPATE_INSTANTIATE(0)
PALPATE_INSTANTIATE(3)
PALPATE_INSTANTIATE(6)
PALPATE_INSTANTIATE(9)
PALPATE_INSTANTIATE(12)
PALPATE_INSTANTIATE(15)
#undef PALPATE_INSTANTIATE

}  // namespace palpate
