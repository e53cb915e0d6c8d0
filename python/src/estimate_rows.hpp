// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/estimate_csv.hpp>
#include <palpate/recording/force_csv.hpp>

#include "arrays.hpp"

namespace palpate::python {

/// From columns time_s, force_tip_N, covariance_tip_N2, status (numbers). Throws InputError.
std::vector<EstimateRow> rows_from(const py::dict& columns);

/// From times and forces. Throws InputError where there is no sample, or times do not increase.
ForceTrace trace_from(const py::object& time_s, const py::object& force_tip_N, const char* name);

}  // namespace palpate::python
