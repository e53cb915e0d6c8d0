// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/registration_model.hpp>

namespace palpate {

/// Covariance of all residuals: white noise over the number of frames, and the tracker's bias, which no averaging
/// takes away. Two mean poses share as much of the bias as their places in the tracker's field are near each other,
/// exp(-d^2 / (2 bias_length^2)). White noise that differs from axis to axis enters as its rms, for the base axes are
/// not known yet. Where the base is tracked, its sensor's errors are common to all sensors of a knob position.
Eigen::MatrixXd registration_noise(const RegistrationModel& model);

}  // namespace palpate
