// SPDX-License-Identifier: Apache-2.0
#include <palpate/estimation/whitened.hpp>

namespace palpate {

namespace {

/// |z|^2 + z^T (information - I)^-1 z.
template <class Vector, class Matrix>
double surprise_of(const Vector& z, Matrix data, double trace) {
  const double floor = std::max(1e-9, 1e-15 * trace);  // above the rounding of the largest
  data.diagonal().array() -= 1.0 - floor;              // directions that the data do not see cost nothing
  const Eigen::LLT<Matrix> factor(data);
  return z.squaredNorm() + (factor.info() == Eigen::Success ? z.dot(factor.solve(z)) : 0.0);
}

}  // namespace

double whitened_surprise(const StateVector& z, const StateMatrix& information, int nuisance) {
  const Eigen::Index n = z.size() - nuisance;
  StateMatrix data = information.topLeftCorner(n, n);
  if (nuisance > 0) {
    const Eigen::LLT<StateMatrix> rest(information.bottomRightCorner(nuisance, nuisance));
    const StateMatrix cross = information.bottomLeftCorner(nuisance, n);
    data -= cross.transpose().lazyProduct(rest.solve(cross));
  }
  return surprise_of(StateVector(z.head(n)), data, information.trace());
}

NoiseFactor::NoiseFactor(const ResidualMatrix& R) : diagonal_(true), definite_(true) {
  const Eigen::Index n = R.rows();
  for (Eigen::Index j = 0; j < n && diagonal_; ++j) diagonal_ = (R.col(j).tail(n - j - 1).array() == 0.0).all();
  if (diagonal_) {
    definite_ = (R.diagonal().array() > 0.0).all();
    inverse_sigma_ = R.diagonal().array().rsqrt();
  } else {
    factor_.compute(R);
    definite_ = factor_.info() == Eigen::Success;
  }
}

void NoiseFactor::whiten(ResidualVector& r) const {
  if (diagonal_)
    r.array() *= inverse_sigma_.array();
  else
    factor_.matrixL().solveInPlace(r);
}

ResidualMatrix NoiseFactor::W() const {
  if (diagonal_) return ResidualMatrix(inverse_sigma_.cwiseInverse().asDiagonal());
  return factor_.matrixL();
}

template <int N>
WhitenedCost<N>::WhitenedCost(const ResidualMatrix& noise, const Gaussian& prior, int nuisance)
    : prior_(prior), nuisance_(nuisance), noise_(noise), prior_factor_(Matrix(prior.covariance)) {}

template <int N>
StateVector WhitenedCost<N>::state(const Vector& z) const {
  return prior_.mean + prior_factor_.matrixL() * z;
}

template <int N>
typename WhitenedCost<N>::Vector WhitenedCost<N>::coordinates(const StateVector& x) const {
  return prior_factor_.matrixL().solve(Vector(x - prior_.mean));
}

template <int N>
double WhitenedCost<N>::model_cost(const Point& point) {
  typename Sized<N>::Jacobian J = point.at.jacobian;
  noise_.whiten_rows(J);
  const Matrix L = prior_factor_.matrixL();
  G_ = J.lazyProduct(L);  // lazy products: the matrices are small
  if (point.root_weight.size() > 0) G_.array().colwise() *= point.root_weight.array();
  information_ = G_.transpose().lazyProduct(G_);
  information_.diagonal().array() += 1.0;
  information_factor_.compute(information_);
  if (point.root_weight.size() > 0)
    gradient_ = G_.transpose().lazyProduct(point.root_weight.cwiseProduct(point.whitened)) - point.z;
  else
    gradient_ = G_.transpose().lazyProduct(point.whitened) - point.z;
  step_ = information_factor_.solve(gradient_);
  return std::sqrt(squared_sigmas(step_));
}

template <int N>
typename WhitenedCost<N>::Vector WhitenedCost<N>::damped_step(double damping) const {
  if (damping == 0.0) return step_;
  Matrix damped = information_;
  damped.diagonal() *= 1.0 + damping;
  return Eigen::LLT<Matrix>(damped).solve(gradient_);
}

template <int N>
double WhitenedCost<N>::promised_fall(const Vector& dz) const {
  return 2.0 * dz.dot(gradient_) - squared_sigmas(dz);
}

template <int N>
double WhitenedCost<N>::squared_sigmas(const Vector& dz) const {
  return dz.dot(information_.lazyProduct(dz));
}

template <int N>
void WhitenedCost<N>::take(const Vector& dz, Point& point) const {
  point.cost -= promised_fall(dz);
  point.z += dz;
  point.at.residual -= point.at.jacobian * Vector(prior_factor_.matrixL() * dz);
  if (point.root_weight.size() > 0)
    point.whitened -= point.root_weight.cwiseInverse().cwiseProduct(G_ * dz);
  else
    point.whitened -= G_.lazyProduct(dz);
}

template <int N>
void WhitenedCost<N>::add_tail_noise(const Point& point, ResidualMatrix& more_noise) const {
  more_noise.resize(0, 0);
  if (point.root_weight.size() == 0) return;
  const ResidualMatrix W = noise_.W();
  const ResidualVector more = point.root_weight.array().square().inverse() - 1.0;
  more_noise = W.lazyProduct(more.asDiagonal().toDenseMatrix().lazyProduct(W.transpose()));
}

template <int N>
void WhitenedCost<N>::conclude(const Point& point, int evaluations, Update& out) const {
  out.posterior.mean = state(point.z);
  out.posterior.covariance = covariance();
  out.chi_square = point.cost;
  out.residual_chi_square = point.whitened.squaredNorm() + point.z.tail(nuisance_).squaredNorm();
  if (nuisance_ == 0)
    out.surprise = surprise_of(point.z, information_, information_.trace());
  else
    out.surprise = whitened_surprise(point.z, information_, nuisance_);
  out.at = point.at;
  out.evaluations = evaluations;
}

/// L (I + G^T G)^-1 L^T = X^T X with X = C^-1 L^T, C C^T = I + G^T G: symmetric, positive definite.
template <int N>
StateMatrix WhitenedCost<N>::covariance() const {
  const Matrix L = prior_factor_.matrixL();
  Matrix X = L.transpose();
  information_factor_.matrixL().solveInPlace(X);
  return X.transpose().lazyProduct(X);
}

template class WhitenedCost<3>;
template class WhitenedCost<Eigen::Dynamic>;

}  // namespace palpate
