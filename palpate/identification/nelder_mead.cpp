// SPDX-License-Identifier: Apache-2.0
#include <nlopt.hpp>
#include <palpate/identification/minimisers.hpp>

namespace palpate::stiffness {

Minimum nelder_mead(const std::function<double(const Eigen::VectorXd& z)>& cost, double step, Eigen::VectorXd& z) {
  constexpr int kMostEvaluations = 5000;
  using Cost = std::function<double(const Eigen::VectorXd&)>;
  const auto call = [](unsigned n, const double* x, double*, void* data) {
    return (*static_cast<const Cost*>(data))(Eigen::Map<const Eigen::VectorXd>(x, static_cast<Eigen::Index>(n)));
  };
  nlopt::opt simplex(nlopt::LN_NELDERMEAD, static_cast<unsigned>(z.size()));
  Cost kept = cost;
  simplex.set_min_objective(call, &kept);
  simplex.set_initial_step(step);
  simplex.set_xtol_abs(1e-7);
  simplex.set_xtol_rel(0.0);
  simplex.set_maxeval(kMostEvaluations);
  std::vector<double> x(z.data(), z.data() + z.size());
  double least = 0.0;
  Minimum minimum;
  try {
    minimum.converged = simplex.optimize(x, least) != nlopt::MAXEVAL_REACHED;
  } catch (const nlopt::roundoff_limited&) {
    minimum.converged = true;  // no better value can be told
  } catch (const std::runtime_error&) {
    minimum.converged = false;
  }
  minimum.iterations = simplex.get_numevals();
  z = Eigen::Map<const Eigen::VectorXd>(x.data(), z.size());
  return minimum;
}

}  // namespace palpate::stiffness
