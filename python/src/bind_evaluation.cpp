// SPDX-License-Identifier: Apache-2.0
#include <pybind11/eigen.h>

#include <algorithm>
#include <cmath>
#include <palpate/evaluation/evaluation.hpp>
#include <palpate/evaluation/force_size.hpp>
#include <palpate/math/units.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "estimate_rows.hpp"

namespace palpate::python {
namespace {

py::dict read_estimate(const py::object& path) {
  const std::vector<EstimateRow> rows = read_estimate_csv(path_text(path, "path"));
  const std::size_t n = rows.size();
  const auto vectors = [&](auto get) {
    return filled(n, {3}, [&](std::size_t i, double* to) { put_rows(get(rows[i]), to); });
  };
  py::dict out;
  out["time_s"] = filled(n, {}, [&](std::size_t i, double* to) { *to = rows[i].time_s; });
  out["force_tip_N"] = vectors([](const EstimateRow& row) { return row.force_tip_N; });
  out["covariance_tip_N2"] =
      filled(n, {3, 3}, [&](std::size_t i, double* to) { put_rows(rows[i].covariance_tip_N2, to); });
  out["status"] = filled<std::int32_t>(
      n, {}, [&](std::size_t i, std::int32_t* to) { *to = static_cast<std::int32_t>(rows[i].status); });
  out["sensors_used"] =
      filled<std::int32_t>(n, {}, [&](std::size_t i, std::int32_t* to) { *to = rows[i].sensors_used; });
  out["nis"] = filled(n, {}, [&](std::size_t i, double* to) { *to = rows[i].nis; });
  out["dof"] = filled<std::int32_t>(n, {}, [&](std::size_t i, std::int32_t* to) { *to = rows[i].dof; });
  // Zero where the file has no such column (EstimateRow): what nobody said is no number, and nothing at all no column.
  const auto if_told = [&](const char* name, auto get) {
    const auto tells = [&](const EstimateRow& row) { return !get(row).isZero(0.0); };
    if (std::none_of(rows.begin(), rows.end(), tells)) return;
    out[name] = vectors([&](const EstimateRow& row) {
      return Vector3d(get(row).unaryExpr([](double told) { return told == 0.0 ? NAN : told; }));
    });
  };
  if_told("stiffness_Nm2", [](const EstimateRow& row) { return row.shaft.stiffness_Nm2; });
  if_told("precurvature_per_m", [](const EstimateRow& row) { return row.shaft.precurvature_per_m; });
  return out;
}

py::dict read_forces(const py::object& path) {
  const ForceTrace trace = read_force_csv(path_text(path, "path"));
  const auto vectors = [](const std::vector<Vector3d>& rows) {
    return filled(rows.size(), {3}, [&](std::size_t i, double* to) { put_rows(rows[i], to); });
  };
  py::dict out;
  out["time_s"] = filled(trace.times_s.size(), {}, [&](std::size_t i, double* to) { *to = trace.times_s[i]; });
  out["force_tip_N"] = vectors(trace.force_tip_N);
  if (!trace.force_base_N.empty()) out["force_base_N"] = vectors(trace.force_base_N);
  return out;
}

py::dict evaluate_columns(const py::dict& estimate, const py::object& time_s, const py::object& force_tip_N,
                          const py::object& skip_s) {
  const Evaluation e =
      evaluate(rows_from(estimate), trace_from(time_s, force_tip_N, "truth"), number(skip_s, "skip_s"));
  py::dict out;
  out["frames"] = e.frames;
  out["outside_truth"] = e.outside_truth;
  out["updated"] = e.updated;
  out["mean_N"] = e.mean_N;
  out["sigma_N"] = e.sigma_N;
  out["rmse_N"] = e.rmse_N;
  out["largest_N"] = e.largest_N;
  out["inside_95"] = e.inside_95;
  out["inside_3_sigma"] = e.inside_3_sigma;
  out["mean_nees"] = e.mean_nees;
  out["indefinite"] = e.indefinite;
  return out;
}

py::dict sizes_of(const py::dict& estimate) {
  const std::vector<ForceSize> sizes = force_sizes(rows_from(estimate));
  const std::size_t n = sizes.size();
  py::dict out;
  out["time_s"] = filled(n, {}, [&](std::size_t i, double* to) { *to = sizes[i].time_s; });
  out["size_N"] = filled(n, {}, [&](std::size_t i, double* to) { *to = sizes[i].size_N; });
  out["sigma_N"] = filled(n, {}, [&](std::size_t i, double* to) { *to = sizes[i].sigma_N; });
  out["measured"] = filled<bool>(n, {}, [&](std::size_t i, bool* to) { *to = sizes[i].measured; });
  return out;
}

}  // namespace

void bind_evaluation(py::module_& m) {
  m.def("read_estimate", &read_estimate);
  m.def("read_forces", &read_forces);
  m.def("evaluate", &evaluate_columns);
  m.def("force_sizes", &sizes_of);
  m.attr("GRAMS_FORCE_PER_NEWTON") = kGramsForcePerNewton;
}

}  // namespace palpate::python
