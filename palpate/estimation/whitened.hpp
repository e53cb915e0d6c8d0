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

/// Types for N states, a number or Eigen::Dynamic: a fixed size spares the common case, a force alone, the general
/// algebra, which would cost more than its rods.
template <int N>
struct Sized {
  static constexpr int most = N == Eigen::Dynamic ? kMaxStates : N;
  using Vector = Eigen::Matrix<double, N, 1, Eigen::ColMajor, most, 1>;
  using Matrix = Eigen::Matrix<double, N, N, Eigen::ColMajor, most, most>;
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, N, Eigen::ColMajor, kMaxResiduals, most>;
};

template <int N>
struct WhitenedPoint {
  typename Sized<N>::Vector z;
  Linearization at;
  ResidualVector whitened;     ///< w
  ResidualVector root_weight;  ///< square root of each row's weight; empty for Gaussian noise
  double cost = 0.0;
};

/// R = W W^T. Where R is diagonal, as without a tracked base or pose errors, so is W.
class NoiseFactor {
 public:
  explicit NoiseFactor(const ResidualMatrix& R);
  bool definite() const { return definite_; }
  void whiten(ResidualVector& r) const;
  template <class Jacobian>
  void whiten_rows(Jacobian& J) const {
    if (diagonal_)
      J.array().colwise() *= inverse_sigma_.array();
    else
      factor_.matrixL().solveInPlace(J);
  }
  ResidualMatrix W() const;

 private:
  bool diagonal_, definite_;
  ResidualVector inverse_sigma_;
  Eigen::LLT<ResidualMatrix> factor_;
};

/// The update in whitened coordinates: x = x0 + L z with P = L L^T, R = W W^T, w = W^-1 r, G = W^-1 J L. The cost is
/// |z|^2 + |w|^2, its Gauss-Newton matrix I + G^T G: definite whatever P and R.
///
/// What does not depend on the model: factors, steps and what follows from them.
template <int N>
class WhitenedCost {
 public:
  using Vector = typename Sized<N>::Vector;
  using Matrix = typename Sized<N>::Matrix;
  using Point = WhitenedPoint<N>;

  /// The prior must outlive it.
  WhitenedCost(const ResidualMatrix& noise, const Gaussian& prior, int nuisance);

  bool definite() const { return noise_.definite() && prior_factor_.info() == Eigen::Success; }
  StateVector state(const Vector& z) const;
  Vector coordinates(const StateVector& x) const;

  /// Gauss-Newton model of the cost around a point; the steps and the covariance that follow are of this one. The
  /// length of its step(), in posterior sigmas.
  double model_cost(const Point& point);

  /// (I + G^T G) dz = G^T w - z.
  const Vector& step() const { return step_; }
  /// Levenberg-Marquardt: the same with (1 + damping) times the diagonal.
  Vector damped_step(double damping) const;
  /// What the model promises a step to take off the cost.
  double promised_fall(const Vector& dz) const;
  /// Squared length of a step in posterior sigmas.
  double squared_sigmas(const Vector& dz) const;
  /// Moves the point the modelled one along, without another look at the measurement model: z, residual and cost.
  void take(const Vector& dz, Point& point) const;

  /// What the weights of heavy tails add to the noise, W (diag(1 / weight) - I) W^T.
  void add_tail_noise(const Point& point, ResidualMatrix& more_noise) const;
  /// The last point and the cost's model become the posterior, after so many `evaluations`.
  void conclude(const Point& point, int evaluations, Update& out) const;

 protected:
  void whiten(ResidualVector& residual) const { noise_.whiten(residual); }

 private:
  StateMatrix covariance() const;

  const Gaussian& prior_;
  int nuisance_;
  NoiseFactor noise_;
  Eigen::LLT<Matrix> prior_factor_;
  typename Sized<N>::Jacobian G_;
  Matrix information_;
  Vector gradient_, step_;
  Eigen::LLT<Matrix> information_factor_;
};

/// The cost of a model.
///
/// With heavy tails a block of m rows, d^2 = |w_block|^2, costs d^2 up to m, and beyond it like a Student t,
/// m + (nu + m) log((nu + d^2) / (nu + m)): its rows count with the weight min(1, (nu + m) / (nu + d^2)), 1 for a good
/// sensor, small for one that is far off. Blocks with correlated noise (a tracked base) are whitened in the order of
/// their rows: each is judged given those before it.
template <MeasurementModel Model, int N>
class Whitened : public WhitenedCost<N> {
 public:
  using Point = WhitenedPoint<N>;
  using Vector = typename Sized<N>::Vector;

  Whitened(Model& model, const Gaussian& prior, int nuisance = 0, double tail_degrees = 0.0)
      : WhitenedCost<N>(noise_of(model), prior, nuisance), model_(model), tail_degrees_(tail_degrees) {}

  /// False where the model has no finite answer.
  bool evaluate(const Vector& z, Point& point) {
    ++evaluations;
    point.z = z;
    if (!model_.linearize(this->state(z), point.at)) return false;
    point.whitened = point.at.residual;
    this->whiten(point.whitened);
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
