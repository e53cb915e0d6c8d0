// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace palpate::rod_lanes {

/// Steps of one piece at most: enough for a thousand times the loads a catheter sees, and a bound on the time of a
/// solve whatever an estimator tries.
inline constexpr int kMostSteps = 200;

/// How finely a piece of the rod is integrated (docs/theory/integrators.md). Angles: length times the largest curvature
/// to expect.
struct StepRule {
  double angle;        ///< of one step of order 8
  double short_angle;  ///< below it one step of order 6 does from the tip, where r = 0: to a sensor just behind it
};

/// Equal steps; a single one may be short.
struct Steps {
  int count;
  bool sixth_order;
};

/// Also defined for loads that are not finite; the solution then is not either.
inline Steps steps_over(double piece_angle, bool at_tip, const StepRule& rule) {
  const double steps = piece_angle / rule.angle;
  return {steps < kMostSteps ? std::max(1, static_cast<int>(std::ceil(steps))) : kMostSteps,
          at_tip && piece_angle < rule.short_angle};
}

}  // namespace palpate::rod_lanes
