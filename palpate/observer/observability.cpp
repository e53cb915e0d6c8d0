// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <cassert>
#include <cmath>
#include <limits>
#include <palpate/estimation/consistency.hpp>
#include <palpate/observer/observability.hpp>

namespace palpate {

std::string_view describe(UncertaintySource source) {
  constexpr std::array<std::string_view, kUncertaintySources> words{"noise", "bias",     "stiffness", "precurvature",
                                                                    "base",  "mounting", "tendon"};
  return words[static_cast<std::size_t>(source)];
}

std::string describe(const Observability& observability) {
  std::string text;
  const auto say = [&](bool so, std::string_view words) {
    if (so) text.append(text.empty() ? "" : "; ").append(words);
  };
  const bool axial = observability.axial_force_hidden;
  say(axial && observability.shaft_straight, "axial force not observable: shaft is straight");
  say(axial && !observability.shaft_straight, "axial force hardly observable");
  say(observability.lateral_force_hidden, "lateral force not observable");
  say(observability.stiffness_rests_on_prior, "stiffness scale rests on the prior");
  say(observability.precurvature_rests_on_prior, "precurvature rests on the prior");
  return text.empty() ? "all observable" : text;
}

/// P = V diag(lambda) V^T: the region e^T P^-1 e <= q, P(chi-square_3 > q) = 1 - share, has semi-axes
/// sqrt(q lambda_i) along V.
ForceEllipsoid force_ellipsoid(const Matrix3d& covariance_N2, double share) {
  assert(share > 0.0 && share < 1.0);
  ForceEllipsoid ellipsoid;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(covariance_N2);
  if (!covariance_N2.allFinite() || eigen.info() != Eigen::Success) {
    ellipsoid.semi_axes_N.setConstant(std::numeric_limits<double>::quiet_NaN());
    return ellipsoid;
  }
  const double q = chi_square_tail_quantile(1.0 - share, 3);
  // Eigen sorts upwards; rounding may leave a covariance of lower rank a little below zero.
  ellipsoid.semi_axes_N = (q * eigen.eigenvalues().reverse().cwiseMax(0.0)).cwiseSqrt();
  ellipsoid.axes = eigen.eigenvectors().rowwise().reverse();
  return ellipsoid;
}

}  // namespace palpate
