// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/eigen.h>

#include <palpate/math/errors.hpp>
#include <palpate/rod/base_loads.hpp>
#include <palpate/rod/reach.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "rod_arguments.hpp"

namespace palpate::python {

Accuracy accuracy_of(const py::object& value) {
  const std::string text = word(value, "accuracy");
  if (text == "realtime") return Accuracy::kRealtime;
  if (text == "reference") return Accuracy::kReference;
  throw InputError(fmt::format("accuracy = '{}': expected realtime or reference", text.substr(0, 60)));
}

std::vector<double> stations_of(const py::object& value, const Rod& rod) {
  std::vector<double> stations_m = to_vector(value, "arc_lengths_m");
  const double end_m = rod.length_m() + rod.rigid_tip_m;
  for (std::size_t i = 0; i < stations_m.size(); ++i)
    if (!(stations_m[i] >= 0.0 && stations_m[i] <= end_m))
      throw InputError(fmt::format("arc_lengths_m[{}] = {}: expected 0 to {} m, the shaft with its rigid tip", i,
                                   stations_m[i], end_m));
  return stations_m;
}

namespace {

py::array vectors(const RodSolution<3>& solution, Vector3d RodPoint::*member) {
  return filled(solution.points.size(), {3},
                [&](std::size_t i, double* out) { put_rows(solution.points[i].*member, out); });
}

py::array columns(const RodSolution<3>& solution, RodPointTangent<3>::Columns RodPointTangent<3>::*member) {
  return filled(solution.tangents.size(), {3, 3},
                [&](std::size_t i, double* out) { put_rows(solution.tangents[i].*member, out); });
}

py::dict as_dict(const RodSolution<3>& solution, bool converged, bool sensitivities) {
  const auto& points = solution.points;
  py::dict out;
  out["position_base_m"] =
      filled(points.size(), {3}, [&](std::size_t i, double* to) { put_rows(points[i].T_base_local.p, to); });
  out["R_base_local"] =
      filled(points.size(), {3, 3}, [&](std::size_t i, double* to) { put_rows(points[i].T_base_local.R, to); });
  out["curvature_per_m"] = vectors(solution, &RodPoint::curvature_per_m);
  out["shear_strain"] = vectors(solution, &RodPoint::shear_strain);
  out["force_local_N"] = vectors(solution, &RodPoint::force_local_N);
  out["moment_local_Nm"] = vectors(solution, &RodPoint::moment_local_Nm);
  out["T_base_tip"] = solution.T_base_tip;
  out["converged"] = converged;
  if (!sensitivities) return out;
  out["d_rotation"] = columns(solution, &RodPointTangent<3>::rotation);
  out["d_position_m"] = columns(solution, &RodPointTangent<3>::position_m);
  out["d_curvature_per_m"] = columns(solution, &RodPointTangent<3>::curvature_per_m);
  return out;
}

py::dict solve(const CatheterFile& file, const py::dict& load, const py::object& arc_lengths_m, bool sensitivities,
               const py::object& accuracy) {
  const Rod& rod = file.catheter.rod;
  const TipLoad tip{.force_tip_N = vector3(load["force_tip_N"], "force_tip_N"),
                    .moment_tip_Nm = vector3(load["moment_tip_Nm"], "moment_tip_Nm"),
                    .tendon_couple_Nm = vector3(load["tendon_couple_Nm"], "tendon_couple_Nm"),
                    .log_stiffness = vector3(load["log_stiffness"], "log_stiffness"),
                    .precurvature_per_m = vector3(load["precurvature_per_m"], "precurvature_per_m")};
  const RodSolver solver(rod, stations_of(arc_lengths_m, rod), accuracy_of(accuracy));
  LoadDirections<3> directions;
  directions.force_tip_N.setIdentity();
  WeightWorkspace<3> workspace = make_weight_workspace<3>(solver);
  RodSolution<3> solution = solver.make_solution<3>();
  const WeightedSolve solved = solve_under_weight<3>(solver, tip, directions, workspace, solution);
  return as_dict(solution, solved.converged && within_reach(solver, tip), sensitivities);
}

}  // namespace

void bind_rod(py::module_& m) { m.def("solve", &solve); }

}  // namespace palpate::python
