// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <palpate/plot/plot.hpp>
#include <palpate/reproduction/methods.hpp>

namespace palpate::reproduction {

/// 0, 1, 2, ...: the paper counts samples.
std::vector<double> step_numbers(std::size_t count);

/// One axis of a sequence of forces [N], times `factor`.
std::vector<double> axis_values(const std::vector<Vector3d>& forces_N, int axis, double factor = 1.0);

inline constexpr std::array<const char*, 3> kForceNames{"Fx", "Fy", "Fz"};

/// |error| of every method, a panel an axis, logarithmic.
plot::Figure error_figure(const std::string& title, const std::vector<MethodRun>& runs);

}  // namespace palpate::reproduction
