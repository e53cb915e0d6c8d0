// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <palpate/identification/stiffness_fit.hpp>
#include <palpate/math/errors.hpp>

namespace palpate::stiffness {

namespace {

/// Nelder and Mead's simplex is for few unknowns: it moves the stiffnesses alone, and the nuisances follow by least
/// squares at every corner. The minimum is that of all together.
Minimum by_simplex(Problem& problem, Eigen::VectorXd& z) {
  constexpr double kFirstStep = 0.1;
  const Eigen::Index stiffnesses = problem.unknowns().free_stiffnesses();
  Eigen::VectorXd all = z, moved = z.head(stiffnesses);
  const auto cost = [&](const Eigen::VectorXd& corner) {
    all.head(stiffnesses) = corner;
    return problem.profiled_cost(all);
  };
  const Minimum minimum = nelder_mead(cost, kFirstStep, moved);
  all.head(stiffnesses) = moved;
  problem.profiled_cost(all);
  z = all;
  return minimum;
}

/// One factor was found; with all stiffnesses free at once, GJ may run away from there. So it goes with EI1 and EI2
/// first: z = E w.
void approach(Problem& problem, Eigen::VectorXd& z) {
  const Unknowns& unknowns = problem.unknowns();
  const auto& all = unknowns.stiffnesses();
  if (all.size() < 3 || all[2].name != "GJ") return;
  const int EI1 = unknowns.index_of(0), EI2 = unknowns.index_of(1), GJ = unknowns.index_of(2);
  if (EI1 < 0 || EI2 < 0 || GJ < 0) return;
  const Eigen::Index n = z.size();
  Eigen::MatrixXd E = Eigen::MatrixXd::Zero(n, n - 1);
  for (Eigen::Index i = 0; i < n; ++i)
    if (i != GJ) E(i, i < GJ ? i : i - 1) = 1.0;
  E(GJ, EI1) = E(GJ, EI2) = 0.5;
  Eigen::VectorXd w(n - 1);
  w << z.head(GJ), z.tail(n - 1 - GJ);
  const Residuals free = problem.residuals();
  const Residuals tied = [&](const Eigen::VectorXd& at, Eigen::VectorXd& r, Eigen::MatrixXd& by_w) {
    Eigen::MatrixXd by_z;
    if (!free(E * at, r, by_z)) return false;
    by_w = by_z * E;
    return true;
  };
  levenberg_marquardt(tied, problem.rows(), w);
  if (problem.evaluate(E * w)) z = E * w;
}

/// Where the points state no sigma, their residuals do: chi^2 over degrees of freedom becomes 1. With nuisances the
/// weight of the prior changes by that, and so does the minimum, a little.
double update_sigma(Problem& problem, const Eigen::VectorXd& z, int degrees_of_freedom) {
  if (problem.sigma_stated() || !problem.evaluate(z)) return 1.0;
  const double ratio = std::sqrt(problem.residual().squaredNorm() / degrees_of_freedom);
  const double least = 1e-12 * problem.unknowns().described().length_m();
  const double sigma = std::max(problem.unknown_sigma_m() * ratio, least);
  const double change = sigma / problem.unknown_sigma_m();
  problem.set_unknown_sigma(sigma);
  return problem.unknowns().nuisances() > 0 ? change : 1.0;
}

void minimise(Fitted& fitted, StiffnessOptions::Method method) {
  constexpr int kMostRounds = 6;
  Problem& problem = fitted.problem;
  int iterations = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    fitted.minimum = method == StiffnessOptions::Method::kNelderMead
                         ? by_simplex(problem, fitted.z)
                         : levenberg_marquardt(problem.residuals(), problem.rows(), fitted.z);
    iterations += fitted.minimum.iterations;
    fitted.degrees_of_freedom = problem.measured() - problem.unknowns().free_stiffnesses();
    if (std::abs(std::log(update_sigma(problem, fitted.z, fitted.degrees_of_freedom))) < 0.01) break;
  }
  fitted.minimum.iterations = iterations;
}

/// chi^2 that one fit in a thousand exceeds: Wilson and Hilferty's cube root.
double hardly_exceeded(int degrees_of_freedom) {
  const double v = 2.0 / (9.0 * degrees_of_freedom);
  return degrees_of_freedom * std::pow(1.0 - v + 3.09 * std::sqrt(v), 3);
}

void judge_residuals(Fitted& fitted) {
  const int dof = fitted.degrees_of_freedom;
  if (!fitted.problem.sigma_stated() || dof < 1 || fitted.chi_square < hardly_exceeded(dof)) return;
  const double ratio = fitted.chi_square / dof;
  fitted.covariance *= ratio;
  fitted.warnings.push_back(
      fmt::format("the residuals are {:.1f} times what the points' sigmas allow: the sigmas of the stiffness were made "
                  "as much larger; a load, a place or the clamp may be wrong",
                  std::sqrt(ratio)));
}

}  // namespace

Fitted fit(const Catheter& catheter, std::span<const LoadCase> cases, const StiffnessOptions& options) {
  check_input(catheter, cases, options);
  Fitted fitted{.problem = Problem(catheter, cases, options)};
  Problem& problem = fitted.problem;
  const double log_scale = find_scale(problem, cases);
  fitted.z = problem.unknowns().start(log_scale);
  // One factor for all may miss by millimetres: as a sigma of the points that would hold what they tell to micrometres.
  hold_untold(problem, fitted.z, fitted.warnings, problem.sigma_stated() ? kToldLogSigma : 1e3 * kToldLogSigma);
  approach(problem, fitted.z);
  minimise(fitted, options.method);
  if (hold_untold(problem, fitted.z, fitted.warnings)) minimise(fitted, options.method);
  if (check_stability(problem, fitted.z, fitted.warnings)) minimise(fitted, options.method);
  if (!problem.evaluate(fitted.z)) throw InputError("stiffness: an equilibrium was lost; are the loads right?");
  if (!fitted.minimum.converged) fitted.warnings.emplace_back("the fit did not converge: its numbers may be off");
  fitted.covariance = covariance_of(problem.jacobian());
  fitted.chi_square = problem.residual().squaredNorm();
  judge_residuals(fitted);
  return fitted;
}

}  // namespace palpate::stiffness
