// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <palpate/batch/batch.hpp>
#include <palpate/math/errors.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "rod_arguments.hpp"

namespace palpate::python {
namespace {

constexpr auto kDouble = static_cast<py::ssize_t>(sizeof(double));

/// Rows over the rods, seen as (n, 3): the numbers stay where the batch wrote them, and live as long as any view.
py::array vectors(const BatchVectors& from, const py::capsule& owner) {
  const py::ssize_t n = from.cols();
  return py::array_t<double>({n, py::ssize_t{3}}, {kDouble, n * kDouble}, from.data(), owner);
}

/// Row 3 i + j, seen as (n, 3, 3).
py::array matrices(const BatchMatrices& from, const py::capsule& owner) {
  const py::ssize_t n = from.cols();
  return py::array_t<double>({n, py::ssize_t{3}, py::ssize_t{3}}, {kDouble, 3 * n * kDouble, n * kDouble}, from.data(),
                             owner);
}

py::dict as_dict(const BatchPoints& points, bool sensitivities, const py::array& converged, const py::capsule& owner) {
  py::dict out;
  out["converged"] = converged;
  out["position_base_m"] = vectors(points.p_base_local_m, owner);
  out["R_base_local"] = matrices(points.R_base_local, owner);
  out["curvature_per_m"] = vectors(points.curvature_per_m, owner);
  if (!sensitivities) return out;
  out["d_rotation"] = matrices(points.d_rotation, owner);
  out["d_position_m"] = matrices(points.d_position_m, owner);
  out["d_curvature_per_m"] = matrices(points.d_curvature_per_m, owner);
  return out;
}

/// Loads of one kind: the rows where they lie; the array keeps them alive. None: zero for all.
class Column {
 public:
  Column(const py::dict& loads, const char* name, py::ssize_t rods) {
    const py::object value = loads[name];
    if (rods == kAnyLength || !value.is_none()) array_ = numbers(value, name, {rods, 3});
  }
  std::span<const Vector3d> rows() const { return array_ ? rows3(array_) : std::span<const Vector3d>{}; }

 private:
  Array array_ = py::reinterpret_steal<Array>(py::handle());
};

int workers_of(const py::object& value) {
  const long workers = whole_number(value, "workers");
  if (workers < 0 || workers > 10000)
    throw InputError(fmt::format("workers = {}: expected 0 (one a core) to 10000", workers));
  return static_cast<int>(workers);
}

py::tuple solve_many(const CatheterFile& file, const py::dict& loads, const py::object& arc_lengths_m,
                     bool sensitivities, const py::object& workers, const py::object& accuracy) {
  const Rod& rod = file.catheter.rod;
  if (rod.has_distributed_load())
    throw InputError(
        "catheter: distributed load (weight_N_per_m): expected none, for a batch has loads in tip "
        "components only; solve() takes weight into account");
  const Column force(loads, "forces_tip_N", kAnyLength);
  const auto n = static_cast<py::ssize_t>(force.rows().size());
  const Column moment(loads, "moments_tip_Nm", n), couple(loads, "tendon_couples_Nm", n),
      log_stiffness(loads, "log_stiffness", n), precurvature(loads, "precurvature_per_m", n);
  const RodSolver solver(rod, stations_of(arc_lengths_m, rod), accuracy_of(accuracy));
  const BatchOptions options{.force_sensitivities = sensitivities, .workers = workers_of(workers)};
  auto solved = std::make_unique<BatchSolution>();
  {
    const OthersRun others_run;
    const BatchLoads all{.force_tip_N = force.rows(),
                         .moment_tip_Nm = moment.rows(),
                         .tendon_couple_Nm = couple.rows(),
                         .log_stiffness = log_stiffness.rows(),
                         .precurvature_per_m = precurvature.rows()};
    solve_batch(solver, all, options, *solved);
  }
  const BatchSolution& kept = *solved;
  const py::capsule owner(solved.get(), [](void* data) { delete static_cast<BatchSolution*>(data); });
  (void)solved.release();  // the capsule has it now
  static_assert(sizeof(bool) == 1);
  const py::array converged(py::dtype::of<bool>(), {n}, {py::ssize_t{1}}, kept.within_reach.data(), owner);
  py::list stations;
  for (const BatchPoints& points : kept.stations) stations.append(as_dict(points, sensitivities, converged, owner));
  return py::make_tuple(as_dict(kept.tip, sensitivities, converged, owner), stations);
}

}  // namespace

void bind_batch(py::module_& m) { m.def("solve_batch", &solve_many); }

}  // namespace palpate::python
