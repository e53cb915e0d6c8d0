// SPDX-License-Identifier: Apache-2.0
#include "estimate_rows.hpp"

#include <fmt/format.h>

#include <palpate/math/errors.hpp>

namespace palpate::python {

namespace {

EstimateStatus status_of(double number) {
  const auto index = static_cast<std::size_t>(number);
  if (!(number >= 0.0) || index >= kEstimateStatuses)
    throw InputError(fmt::format("estimate: status {}: expected 0 to {}", number, kEstimateStatuses - 1));
  return static_cast<EstimateStatus>(index);
}

}  // namespace

std::vector<EstimateRow> rows_from(const py::dict& columns) {
  const Array times = numbers(columns["time_s"], "estimate.time_s", {kAnyLength}, Values::kAny);
  const py::ssize_t n = times.size();
  const Array force = numbers(columns["force_tip_N"], "estimate.force_tip_N", {n, 3}, Values::kAny);
  const Array covariance = numbers(columns["covariance_tip_N2"], "estimate.covariance_tip_N2", {n, 3, 3}, Values::kAny);
  const Array status = numbers(columns["status"], "estimate.status", {n});
  std::vector<EstimateRow> rows(static_cast<std::size_t>(n));
  for (py::ssize_t i = 0; i < n; ++i) {
    EstimateRow& row = rows[static_cast<std::size_t>(i)];
    row.time_s = times.data()[i];
    row.force_tip_N = Eigen::Map<const Vector3d>(force.data() + 3 * i);
    row.covariance_tip_N2 = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(covariance.data() + 9 * i);
    row.status = status_of(status.data()[i]);
  }
  return rows;
}

ForceTrace trace_from(const py::object& time_s, const py::object& force_tip_N, const char* name) {
  ForceTrace trace{.source = name,
                   .times_s = to_vector(time_s, fmt::format("{}.time_s", name)),
                   .force_tip_N = {},
                   .force_base_N = {}};
  const Array forces =
      numbers(force_tip_N, fmt::format("{}.force_tip_N", name), {static_cast<py::ssize_t>(trace.times_s.size()), 3});
  const auto rows = rows3(forces);
  trace.force_tip_N.assign(rows.begin(), rows.end());
  if (trace.times_s.empty()) throw InputError(fmt::format("{}: expected at least one sample", name));
  for (std::size_t i = 1; i < trace.times_s.size(); ++i)
    if (!(trace.times_s[i] > trace.times_s[i - 1]))
      throw InputError(fmt::format("{}.time_s[{}] = {}: expected more than {}, the time before", name, i,
                                   trace.times_s[i], trace.times_s[i - 1]));
  return trace;
}

}  // namespace palpate::python
