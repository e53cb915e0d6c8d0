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
double whitened_surprise(const StateVector& z, const StateMatrix& information, int nuisance = 0);

struct WhitenedPoint {
  StateVector z;
  Linearization at;
  ResidualVector whitened;     ///< w
  ResidualVector root_weight;  ///< square root of each row's weight; empty for Gaussian noise
  double cost = 0.0;
};

/// The update in whitened coordinates: x = x0 + L z with P = L L^T, R = W W^T, w = W^-1 r, G = W^-1 J L. The cost is
/// |z|^2 + |w|^2, its Gauss-Newton matrix I + G^T G: definite whatever P and R.
///
/// What does not depend on the model: factors, steps and what follows from them.
class WhitenedCost {
 public:
  /// The prior must outlive it.
  WhitenedCost(const ResidualMatrix& noise, const Gaussian& prior, int nuisance);

  bool definite() const { return noise_factor_.info() == Eigen::Success && prior_factor_.info() == Eigen::Success; }
  StateVector state(const StateVector& z) const;
  StateVector coordinates(const StateVector& x) const;

  /// Gauss-Newton model of the cost around a point; the steps and the covariance that follow are of this one.
  void model_cost(const WhitenedPoint& point);

  /// (I + G^T G) dz = G^T w - z.
  StateVector step() const;
  /// Levenberg-Marquardt: the same with (1 + damping) times the diagonal.
  StateVector damped_step(double damping) const;
  /// What the model promises a step to take off the cost.
  double promised_fall(const StateVector& dz) const;
  /// Squared length of a step in posterior sigmas.
  double squared_sigmas(const StateVector& dz) const;

  /// What the weights of heavy tails add to the noise, W (diag(1 / weight) - I) W^T.
  void add_tail_noise(const WhitenedPoint& point, ResidualMatrix& more_noise) const;
  /// The last point and the cost's model there become the posterior, after so many `evaluations`.
  void conclude(const WhitenedPoint& point, int evaluations, Update& out) const;

 protected:
  void whiten(ResidualVector& residual) const { noise_factor_.matrixL().solveInPlace(residual); }

 private:
  StateMatrix covariance() const;

  const Gaussian& prior_;
  int nuisance_;
  Eigen::LLT<ResidualMatrix> noise_factor_;
  Eigen::LLT<StateMatrix> prior_factor_;
  JacobianMatrix G_;
  StateMatrix information_;
  StateVector gradient_;
  Eigen::LLT<StateMatrix> information_factor_;
};

/// The cost of a model.
///
/// With heavy tails a block of m rows, d^2 = |w_block|^2, costs d^2 up to m, and beyond it like a Student t,
/// m + (nu + m) log((nu + d^2) / (nu + m)): its rows count with the weight min(1, (nu + m) / (nu + d^2)), 1 for a good
/// sensor, small for one that is far off. Blocks with correlated noise (a tracked base) are whitened in the order of
/// their rows: each is judged given those before it.
template <MeasurementModel Model>
class Whitened : public WhitenedCost {
 public:
  using Point = WhitenedPoint;

  Whitened(Model& model, const Gaussian& prior, int nuisance = 0, double tail_degrees = 0.0)
      : WhitenedCost(noise_of(model), prior, nuisance), model_(model), tail_degrees_(tail_degrees) {}

  /// False where the model has no finite answer.
  bool evaluate(const StateVector& z, Point& point) {
    ++evaluations;
    point.z = z;
    if (!model_.linearize(state(z), point.at)) return false;
    point.whitened = point.at.residual;
    whiten(point.whitened);
    point.cost = z.squaredNorm() + data_cost(point);
    return std::isfinite(point.cost);
  }

  int evaluations = 0;

 private:
  static ResidualMatrix noise_of(Model& model) {
    ResidualMatrix noise;
    model.noise(noise);
    return noise;
  }

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
  double tail_degrees_;
};

}  // namespace palpate
