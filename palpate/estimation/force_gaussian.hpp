// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/math/rotation.hpp>

/// What one frame says about the force, as numbers that do not depend on the model of motion. Fixed size; nothing here
/// allocates or throws.
namespace palpate {

/// A force in tip axes, N(mean, covariance).
struct ForceGaussian {
  Vector3d mean_N = Vector3d::Zero();
  Matrix3d covariance_N2 = Matrix3d::Identity();
};

/// One frame's likelihood of the force, exp(-F^T Lambda F / 2 + eta^T F): what its sensors add to any prior. Directions
/// that they do not see have no information.
struct ForceLikelihood {
  Matrix3d information_per_N2 = Matrix3d::Zero();      ///< Lambda = J^T R^-1 J
  Vector3d information_mean_per_N = Vector3d::Zero();  ///< eta = Lambda F_ml
};

/// The likelihood that turned `prior` into `posterior`: Lambda = P+^-1 - P-^-1, eta = P+^-1 F+ - P-^-1 F-, with
/// negative eigenvalues of Lambda (rounding) set to zero and eta = Lambda F+ + P-^-1 (F+ - F-) kept in its range. All
/// zero where a covariance is not positive definite.
ForceLikelihood likelihood_between(const ForceGaussian& prior, const ForceGaussian& posterior);

/// Prior times likelihood: with P = L L^T, P+ = L (I + L^T Lambda L)^-1 L^T and F+ = F + P+ (eta - Lambda F). Definite
/// whatever the prior; the prior where its covariance is not.
ForceGaussian posterior_of(const ForceGaussian& prior, const ForceLikelihood& likelihood);

/// No force is believed to be larger than N(0, limit^2) says, axis by axis: an axis of larger variance v is conditioned
/// on F_i = 0 with the noise v limit^2 / (v - limit^2) that brings its variance to limit^2. Keeps extrapolation and
/// directions that no sensor sees from running away; leaves a known force alone.
ForceGaussian within_belief(const ForceGaussian& force, double limit_N);

}  // namespace palpate
