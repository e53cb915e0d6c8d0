// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/identification/stiffness_problem.hpp>

/// What identify_stiffness() does beside minimising.
namespace palpate::stiffness {

/// Throws InputError, naming the case, the point and the value, on input that cannot tell a stiffness.
void check_input(const Catheter& catheter, std::span<const LoadCase> cases, const StiffnessOptions& options);

/// Logarithm of the common factor on all stiffnesses that suits the shapes best, of factors from 1e-4 to 1e4. The shaft
/// is softened step by step from one that no load bends, so that every case follows its branch from rest. Leaves the
/// problem at that scale. Throws InputError where none suits better than no load, or the shapes hardly differ from it.
double find_scale(Problem& problem, std::span<const LoadCase> cases);

/// One standard deviation of unknown `index` of z, from the Jacobian's columns: alone = all others known.
double sigma_of(const Eigen::MatrixXd& jacobian, Eigen::Index index, bool alone = false);

/// Log sigma from which on a stiffness is not told: a factor of e either way is not worth writing into a file.
inline constexpr double kToldLogSigma = 1.0;

/// Holds, one after the other, the stiffnesses that the problem's Jacobian at z does not tell to `most_log_sigma`,
/// worst first; a warning each. True if there was one; z then is without it. Throws InputError where none is left.
bool hold_untold(Problem& problem, Eigen::VectorXd& z, std::vector<std::string>& warnings,
                 double most_log_sigma = kToldLogSigma);

/// Where the branch of a case may have lost its stability on the way, it is followed again with the shaft at z, in
/// small steps. A warning for a load past a bifurcation. True: a shape lay on another branch; the problem now is on
/// the right one.
bool check_stability(Problem& problem, const Eigen::VectorXd& z, std::vector<std::string>& warnings);

/// (J^T J)^-1 by an orthogonal factor of J with its columns scaled.
Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& jacobian);

}  // namespace palpate::stiffness
