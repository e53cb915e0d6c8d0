// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/plot/plot.hpp>

#include "identify_stiffness_report.hpp"

namespace palpate::app {

/// Measured points and fitted shapes, seen along both lateral axes of the base, with the 95 % band that the sigma of
/// the stiffness leaves, and the residuals of each axis. Lateral axes in which nothing was measured are left out.
plot::Figure stiffness_figure(const StiffnessReport& report, const Catheter& before);

}  // namespace palpate::app
