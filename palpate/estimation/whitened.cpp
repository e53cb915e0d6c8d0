// SPDX-License-Identifier: Apache-2.0
#include <palpate/estimation/whitened.hpp>

namespace palpate {

double whitened_surprise(const StateVector& z, const StateMatrix& information, int nuisance) {
  const Eigen::Index n = z.size() - nuisance;
  StateMatrix data = information.topLeftCorner(n, n);
  if (nuisance > 0) {
    const Eigen::LLT<StateMatrix> rest(information.bottomRightCorner(nuisance, nuisance));
    const StateMatrix cross = information.bottomLeftCorner(nuisance, n);
    data -= cross.transpose().lazyProduct(rest.solve(cross));
  }
  const double floor = std::max(1e-9, 1e-15 * information.trace());  // above the rounding of the largest
  data.diagonal().array() -= 1.0 - floor;                            // directions that the data do not see cost nothing
  const Eigen::LLT<StateMatrix> factor(data);
  const StateVector leading = z.head(n);
  return leading.squaredNorm() + (factor.info() == Eigen::Success ? leading.dot(factor.solve(leading)) : 0.0);
}

WhitenedCost::WhitenedCost(const ResidualMatrix& noise, const Gaussian& prior, int nuisance)
    : prior_(prior), nuisance_(nuisance), noise_factor_(noise), prior_factor_(prior.covariance) {}

StateVector WhitenedCost::state(const StateVector& z) const { return prior_.mean + prior_factor_.matrixL() * z; }

StateVector WhitenedCost::coordinates(const StateVector& x) const {
  return prior_factor_.matrixL().solve(x - prior_.mean);
}

void WhitenedCost::model_cost(const WhitenedPoint& point) {
  G_ = point.at.jacobian;
  noise_factor_.matrixL().solveInPlace(G_);
  const StateMatrix L = prior_factor_.matrixL();
  G_ = G_.lazyProduct(L).eval();  // lazy products: the matrices are small
  if (point.root_weight.size() > 0) G_ = (point.root_weight.asDiagonal() * G_).eval();
  information_ = G_.transpose().lazyProduct(G_);
  information_.diagonal().array() += 1.0;
  information_factor_.compute(information_);
  if (point.root_weight.size() > 0)
    gradient_ = G_.transpose().lazyProduct(point.root_weight.cwiseProduct(point.whitened)) - point.z;
  else
    gradient_ = G_.transpose().lazyProduct(point.whitened) - point.z;
}

StateVector WhitenedCost::step() const { return information_factor_.solve(gradient_); }

StateVector WhitenedCost::damped_step(double damping) const {
  StateMatrix damped = information_;
  damped.diagonal() *= 1.0 + damping;
  return Eigen::LLT<StateMatrix>(damped).solve(gradient_);
}

double WhitenedCost::promised_fall(const StateVector& dz) const {
  return 2.0 * dz.dot(gradient_) - dz.dot(information_ * dz);
}

double WhitenedCost::squared_sigmas(const StateVector& dz) const { return dz.dot(information_ * dz); }

void WhitenedCost::add_tail_noise(const WhitenedPoint& point, ResidualMatrix& more_noise) const {
  more_noise.resize(0, 0);
  if (point.root_weight.size() == 0) return;
  const ResidualMatrix W = noise_factor_.matrixL();
  const ResidualVector more = point.root_weight.array().square().inverse() - 1.0;
  more_noise = W.lazyProduct(more.asDiagonal().toDenseMatrix().lazyProduct(W.transpose()));
}

void WhitenedCost::conclude(const WhitenedPoint& point, int evaluations, Update& out) const {
  out.posterior.mean = state(point.z);
  out.posterior.covariance = covariance();
  out.chi_square = point.cost;
  out.residual_chi_square = point.whitened.squaredNorm() + point.z.tail(nuisance_).squaredNorm();
  out.surprise = whitened_surprise(point.z, information_, nuisance_);
  out.at = point.at;
  out.evaluations = evaluations;
}

/// Joseph form, L [(I - K G)(I - K G)^T + K K^T] L^T with K = (I + G^T G)^-1 G^T: symmetric, positive definite.
StateMatrix WhitenedCost::covariance() const {
  const Eigen::Index n = prior_.mean.size();
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxStates, kMaxResiduals> K =
      information_factor_.solve(G_.transpose());
  const StateMatrix I_KG = StateMatrix::Identity(n, n) - K.lazyProduct(G_);
  const StateMatrix L = prior_factor_.matrixL();
  const StateMatrix inner = I_KG.lazyProduct(I_KG.transpose()) + K.lazyProduct(K.transpose());
  const StateMatrix P = L.lazyProduct(inner).eval().lazyProduct(L.transpose());
  return 0.5 * (P + P.transpose());
}

}  // namespace palpate
