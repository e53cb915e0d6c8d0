// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <palpate/estimation/update.hpp>

namespace palpate {

/// |z|^2 + z^T (G^T G)^-1 z, with `information` = I + G^T G: at the optimum z = G^T w, and this is how far the data
/// alone would have gone, in sigmas of data and prior together. The last `nuisance` states count among the data: of the
/// information the Schur complement over them is left.
inline double whitened_surprise(const StateVector& z, const StateMatrix& information, int nuisance = 0) {
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

/// The update in whitened coordinates: x = x0 + L z with P = L L^T, R = W W^T, w = W^-1 r, G = W^-1 J L. The cost is
/// |z|^2 + |w|^2, its Gauss-Newton matrix I + G^T G: definite whatever P and R.
///
/// With heavy tails a block of m rows, d^2 = |w_block|^2, costs d^2 up to m, and beyond it like a Student t,
/// m + (nu + m) log((nu + d^2) / (nu + m)): its rows count with the weight min(1, (nu + m) / (nu + d^2)), 1 for a good
/// sensor, small for one that is far off. Blocks with correlated noise (a tracked base) are whitened in the order of
/// their rows: each is judged given those before it.
template <MeasurementModel Model>
class Whitened {
 public:
  Whitened(Model& model, const Gaussian& prior, int nuisance = 0, double tail_degrees = 0.0)
      : model_(model), prior_(prior), nuisance_(nuisance), tail_degrees_(tail_degrees) {
    ResidualMatrix noise;
    model_.noise(noise);
    noise_factor_.compute(noise);
    prior_factor_.compute(prior_.covariance);
  }

  bool definite() const { return noise_factor_.info() == Eigen::Success && prior_factor_.info() == Eigen::Success; }
  StateVector state(const StateVector& z) const { return prior_.mean + prior_factor_.matrixL() * z; }
  StateVector coordinates(const StateVector& x) const { return prior_factor_.matrixL().solve(x - prior_.mean); }

  struct Point {
    StateVector z;
    Linearization at;
    ResidualVector whitened;     ///< w
    ResidualVector root_weight;  ///< square root of each row's weight; empty for Gaussian noise
    double cost = 0.0;
  };

  /// False where the model has no finite answer.
  bool evaluate(const StateVector& z, Point& point) {
    ++evaluations;
    point.z = z;
    if (!model_.linearize(state(z), point.at)) return false;
    point.whitened = point.at.residual;
    noise_factor_.matrixL().solveInPlace(point.whitened);
    point.cost = z.squaredNorm() + data_cost(point);
    return std::isfinite(point.cost);
  }

  /// Gauss-Newton model of the cost around a point; the steps and the covariance that follow are of this one.
  void model_cost(const Point& point) {
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

  /// (I + G^T G) dz = G^T w - z.
  StateVector step() const { return information_factor_.solve(gradient_); }

  /// Levenberg-Marquardt: the same with (1 + damping) times the diagonal.
  StateVector damped_step(double damping) const {
    StateMatrix damped = information_;
    damped.diagonal() *= 1.0 + damping;
    return Eigen::LLT<StateMatrix>(damped).solve(gradient_);
  }

  /// What the model promises a step to take off the cost.
  double promised_fall(const StateVector& dz) const { return 2.0 * dz.dot(gradient_) - dz.dot(information_ * dz); }

  /// Squared length of a step in posterior sigmas.
  double squared_sigmas(const StateVector& dz) const { return dz.dot(information_ * dz); }

  /// Update::surprise at the optimum.
  double surprise(const StateVector& z) const { return whitened_surprise(z, information_, nuisance_); }

  /// Update::residual_chi_square.
  double misfit(const Point& point) const {
    return point.whitened.squaredNorm() + point.z.tail(nuisance_).squaredNorm();
  }

  /// What the weights of heavy tails add to the noise, W (diag(1 / weight) - I) W^T.
  void add_tail_noise(const Point& point, ResidualMatrix& more_noise) const {
    more_noise.resize(0, 0);
    if (point.root_weight.size() == 0) return;
    const ResidualMatrix W = noise_factor_.matrixL();
    const ResidualVector more = point.root_weight.array().square().inverse() - 1.0;
    more_noise = W.lazyProduct(more.asDiagonal().toDenseMatrix().lazyProduct(W.transpose()));
  }

  /// Joseph form, L [(I - K G)(I - K G)^T + K K^T] L^T with K = (I + G^T G)^-1 G^T: symmetric, positive definite.
  StateMatrix covariance() const {
    const Eigen::Index n = prior_.mean.size();
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxStates, kMaxResiduals> K =
        information_factor_.solve(G_.transpose());
    const StateMatrix I_KG = StateMatrix::Identity(n, n) - K.lazyProduct(G_);
    const StateMatrix L = prior_factor_.matrixL();
    const StateMatrix inner = I_KG.lazyProduct(I_KG.transpose()) + K.lazyProduct(K.transpose());
    const StateMatrix P = L.lazyProduct(inner).eval().lazyProduct(L.transpose());
    return 0.5 * (P + P.transpose());
  }

  int evaluations = 0;

 private:
  double data_cost(Point& point) const {
    if constexpr (BlockModel<Model>)
      if (tail_degrees_ > 0.0) return tail_cost(point);
    return point.whitened.squaredNorm();
  }

  double tail_cost(Point& point) const requires BlockModel<Model> {
    const double nu = tail_degrees_;
    double cost = 0.0;
    point.root_weight.resize(point.whitened.size());
    for (int row = 0; row < point.whitened.size();) {
      const int end = model_.block_end(row), m = end - row;
      const double d2 = point.whitened.segment(row, m).squaredNorm();
      const double weight = std::min(1.0, (nu + m) / (nu + d2));
      cost += weight < 1.0 ? m - (nu + m) * std::log(weight) : d2;
      point.root_weight.segment(row, m).setConstant(std::sqrt(weight));
      row = end;
    }
    return cost;
  }

  Model& model_;
  const Gaussian& prior_;
  int nuisance_;
  double tail_degrees_;
  Eigen::LLT<ResidualMatrix> noise_factor_;
  Eigen::LLT<StateMatrix> prior_factor_;
  JacobianMatrix G_;
  StateMatrix information_;
  StateVector gradient_;
  Eigen::LLT<StateMatrix> information_factor_;
};

}  // namespace palpate
