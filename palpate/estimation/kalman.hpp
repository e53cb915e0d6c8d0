// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <concepts>
#include <palpate/math/linearization.hpp>

/// Measurement updates of the extended and the iterated extended Kalman filter, for any measurement model. The filters
/// know no rods. No allocation, no exception.
namespace palpate {

/// What a filter needs of a measurement: its size, its noise, and residual and Jacobian at a state.
template <class M>
concept MeasurementModel = requires(M& model, const StateVector& x, Linearization& at, ResidualMatrix& noise) {
  { model.rows() } -> std::convertible_to<int>;
  {model.noise(noise)};                              ///< covariance of the residual, rows x rows
  { model.linearize(x, at) } -> std::same_as<bool>;  ///< false: no finite solution at x
};

/// Mean and covariance.
struct Gaussian {
  StateVector mean;
  StateMatrix covariance;
};

struct UpdateOptions {
  int max_iterations = 10;       ///< steps of the iterated update; range [1, 100]
  double step_tolerance = 1e-2;  ///< converged when the next step is this small, in posterior sigmas; range (0, 1]
};

enum class UpdateStatus {
  kConverged,
  kNotConverged,  ///< iterations ran out; the posterior is the best iterate
  kFailed,        ///< no finite linearization at the prior mean, or a covariance lost definiteness; posterior = prior
};

struct Update {
  UpdateStatus status = UpdateStatus::kFailed;
  Gaussian posterior;
  double chi_square = 0.0;           ///< twice the MAP cost at the posterior; for a linear model nu^T S^-1 nu, the NIS
  double residual_chi_square = 0.0;  ///< the measurement's share of it: r^T R^-1 r, post-fit
  int rows = 0;
  int evaluations = 0;        ///< of the model
  ResidualVector innovation;  ///< residual where the search began: at the prior mean, unless told otherwise
  Linearization at;           ///< at the posterior mean, but for a last step below the tolerance
};

namespace detail {

/// The update in whitened coordinates: x = x0 + L z with P = L L^T, R = W W^T, G = W^-1 J L. The cost is
/// (|z|^2 + |W^-1 r|^2) / 2, its Gauss-Newton matrix I + G^T G: definite whatever P and R.
template <MeasurementModel Model>
class WhitenedUpdate {
 public:
  WhitenedUpdate(Model& model, const Gaussian& prior) : model_(model), prior_(prior) {
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
    ResidualVector whitened;  ///< W^-1 r
    double cost = 0.0;        ///< |z|^2 + |W^-1 r|^2
  };

  /// False where the model has no finite answer.
  bool evaluate(const StateVector& z, Point& point) {
    ++evaluations;
    point.z = z;
    if (!model_.linearize(state(z), point.at)) return false;
    point.whitened = point.at.residual;
    noise_factor_.matrixL().solveInPlace(point.whitened);
    point.cost = z.squaredNorm() + point.whitened.squaredNorm();
    return std::isfinite(point.cost);
  }

  /// Gauss-Newton step (I + G^T G) dz = G^T W^-1 r - z; keeps the matrix for sigmas() and covariance().
  StateVector step(const Point& point) {
    G_ = point.at.jacobian;
    noise_factor_.matrixL().solveInPlace(G_);
    const StateMatrix L = prior_factor_.matrixL();
    G_ = G_.lazyProduct(L).eval();  // lazy products: the matrices are small
    information_ = G_.transpose().lazyProduct(G_);
    information_.diagonal().array() += 1.0;
    information_factor_.compute(information_);
    const StateVector gradient = G_.transpose().lazyProduct(point.whitened) - point.z;
    return information_factor_.solve(gradient);
  }

  /// Squared length of a step in posterior sigmas.
  double squared_sigmas(const StateVector& dz) const { return dz.dot(information_ * dz); }

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
  Model& model_;
  const Gaussian& prior_;
  Eigen::LLT<ResidualMatrix> noise_factor_;
  Eigen::LLT<StateMatrix> prior_factor_;
  JacobianMatrix G_;
  StateMatrix information_;
  Eigen::LLT<StateMatrix> information_factor_;
};

/// Halves the step until the cost falls; false where it never does.
template <class Whitened>
bool descend(Whitened& whitened, const StateVector& dz, typename Whitened::Point& point) {
  constexpr int kMaxHalvings = 8;
  typename Whitened::Point trial;
  double share = 1.0;
  for (int i = 0; i <= kMaxHalvings; ++i, share *= 0.5) {
    if (!whitened.evaluate(point.z + share * dz, trial) || !(trial.cost < point.cost)) continue;
    point = trial;
    return true;
  }
  return false;
}

}  // namespace detail

/// Iterated extended Kalman update (paper, section 3.3.1): the maximum of the posterior by Gauss-Newton steps from
/// `start` (the prior mean, unless there is a better guess), each halved until the cost falls. `out.posterior` is the
/// prior where the status is kFailed. At most 1 + 9 max_iterations evaluations. Source: Bell and Cathey 1993.
template <MeasurementModel Model>
void iterated_update(Model& model, const Gaussian& prior, const StateVector& start, const UpdateOptions& options,
                     Update& out) {
  out.status = UpdateStatus::kFailed;
  out.posterior = prior;
  out.rows = model.rows();
  detail::WhitenedUpdate<Model> whitened(model, prior);
  typename detail::WhitenedUpdate<Model>::Point point;
  const bool usable = whitened.definite() && whitened.evaluate(whitened.coordinates(start), point);
  out.evaluations = whitened.evaluations;
  if (!usable) return;

  out.status = UpdateStatus::kNotConverged;
  out.innovation = point.at.residual;
  StateVector dz = whitened.step(point);
  const double tolerance = options.step_tolerance * options.step_tolerance;
  for (int i = 0; i < options.max_iterations && whitened.squared_sigmas(dz) > tolerance; ++i) {
    if (!detail::descend(whitened, dz, point)) break;
    dz = whitened.step(point);
  }
  if (whitened.squared_sigmas(dz) <= tolerance) {
    out.status = UpdateStatus::kConverged;
    point.z += dz;  // below the tolerance: taken without another evaluation
  }
  out.posterior.mean = whitened.state(point.z);
  out.posterior.covariance = whitened.covariance();
  out.chi_square = point.cost;
  out.residual_chi_square = point.whitened.squaredNorm();
  out.at = point.at;
  out.evaluations = whitened.evaluations;
}

/// Extended Kalman update, Eq. (17): one step from the prior mean, and one evaluation more for the post-fit residual.
template <MeasurementModel Model>
void extended_update(Model& model, const Gaussian& prior, Update& out) {
  out.status = UpdateStatus::kFailed;
  out.posterior = prior;
  out.rows = model.rows();
  detail::WhitenedUpdate<Model> whitened(model, prior);
  typename detail::WhitenedUpdate<Model>::Point point;
  const StateVector origin = StateVector::Zero(prior.mean.size());
  const bool usable = whitened.definite() && whitened.evaluate(origin, point);
  out.evaluations = whitened.evaluations;
  if (!usable) return;

  out.innovation = point.at.residual;
  const StateVector dz = whitened.step(point);
  out.posterior.mean = whitened.state(dz);
  out.posterior.covariance = whitened.covariance();
  out.chi_square = point.cost - whitened.squared_sigmas(dz);
  out.status = whitened.evaluate(dz, point) ? UpdateStatus::kConverged : UpdateStatus::kNotConverged;
  if (out.status == UpdateStatus::kConverged) out.residual_chi_square = point.whitened.squaredNorm();
  out.at = point.at;
  out.evaluations = whitened.evaluations;
}

}  // namespace palpate
