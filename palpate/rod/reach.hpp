// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/rod/statics.hpp>

namespace palpate {

/// False where some piece of the rod wants more steps than a solve takes (rod_lanes::kMostSteps), so that the shape is
/// not as accurate as asked, or no number at all: beyond a thousand times a catheter's loads, or for a load that is not
/// finite. Some nanoseconds.
bool within_reach(const RodSolver& solver, const TipLoad& load);
/// The same under a load of this curvature bound.
bool within_reach(const RodSolver& solver, double curvature_bound_per_m);

}  // namespace palpate
