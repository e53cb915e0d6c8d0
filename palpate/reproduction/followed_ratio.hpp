// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/reproduction/virtual_paper.hpp>

namespace palpate::reproduction {

/// CFSE as Palpate states it: the state is f = F / EI in newtons of the catheter file's stiffness, which the shape
/// tells, and log EI1, log EI2, constant, with a stated prior; F = exp(E log EI) f carries the prior's sigma along.
/// Measurement of Eq. (11) at the paper's 1 mm and 0.0012 rad^2, the noise of the curvature following from the
/// orientations'. `stiffness_factor` and `stiffness_sigma` of the start are those of the file; Q per axis and step.
Run follow_ratio(const Catheter& catheter, const Course& course, double Q_N2, const Start& start);

}  // namespace palpate::reproduction
