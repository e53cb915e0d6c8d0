// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <palpate/identification/registration_model.hpp>

namespace palpate {

/// What a registration weighs: the residuals by their noise, the unknowns by what is believed of them beforehand.
struct RegistrationWeights {
  static constexpr double kFree = std::numeric_limits<double>::infinity();
  static constexpr double kFixed = 1e-9;  ///< sigma of what stays: small enough not to move, finite all the same
  Eigen::MatrixXd noise_factor;           ///< lower Cholesky factor of the residuals' covariance
  Eigen::VectorXd prior_sigma;            ///< of every unknown about the stated value; kFree: nothing is believed
};

RegistrationWeights weights_of(const RegistrationModel& model, const RegistrationOptions& options);

/// Whitened residuals, those of the priors below, and their derivatives by x; the cost is half the sum of squares.
struct WhitenedRegistration {
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
};
bool whiten(RegistrationModel& model, const RegistrationWeights& weights, const RegistrationState& from,
            const Eigen::VectorXd& x, WhitenedRegistration& at);

struct RegistrationFit {
  bool converged = false;
  RegistrationState state = {};
  Eigen::VectorXd x = {};  ///< `state` as a step away from the stated one; its base part is zero
  double chi_square = std::numeric_limits<double>::infinity();
  int iterations = 0;
};

/// Levenberg-Marquardt from one start, with exact sensitivities.
RegistrationFit fit_registration(RegistrationModel& model, const RegistrationWeights& weights,
                                 const RegistrationState& start, int most_iterations);

}  // namespace palpate
