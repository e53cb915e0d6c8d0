// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <palpate/identification/stiffness.hpp>
#include <palpate/recording/toml_edit.hpp>

namespace palpate::app {

/// One sigma and one correlation for EI1, EI2 and GJ: what a catheter file can say of them.
struct CommonSigma {
  double fraction = 0.0;     ///< at most 1
  double correlation = 0.0;  ///< 0..0.999
};

/// The least common sigma under which no combination of (ln EI1, ln EI2, ln GJ) is claimed better than it was found:
/// s^2 ((1 - c) I + c 1 1^T) >= covariance, c the mean of the correlations found. An unknown that the loads do not tell
/// keeps the sigma of `before`; if that states none, 100 %.
CommonSigma common_sigma(const StiffnessFit& fit, StiffnessOptions::Unknowns unknowns, const Catheter& before);

/// Covariance of (ln EI1, ln EI2, ln GJ); what is not told as in common_sigma.
Matrix3d log_stiffness_covariance(const StiffnessFit& fit, StiffnessOptions::Unknowns unknowns, const Catheter& before);

/// The catheter file with the identified stiffness in place of the old one, with sigma and correlation. Modulus,
/// diameter and Poisson's ratio give way to bending and torsional stiffness. `before`: what the file says now.
TomlEdit with_identified_stiffness(const std::filesystem::path& catheter_file, const Catheter& before,
                                   const StiffnessFit& fit, StiffnessOptions::Unknowns unknowns);

}  // namespace palpate::app
