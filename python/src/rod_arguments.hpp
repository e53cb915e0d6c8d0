// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <palpate/rod/statics.hpp>
#include <vector>

/// Arguments that the single rod and the batch have in common.
namespace palpate::python {

/// "realtime" or "reference". Throws InputError.
Accuracy accuracy_of(const pybind11::object& value);

/// Places along the shaft. Throws InputError naming the one that lies outside.
std::vector<double> stations_of(const pybind11::object& value, const Rod& rod);

}  // namespace palpate::python
