// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <limits>
#include <palpate/math/linearization.hpp>

/// What every measurement update takes and gives. The filters know no rods.
namespace palpate {

/// What a filter needs of a measurement: its size, its noise, and residual and Jacobian at a state.
template <class M>
concept MeasurementModel = requires(M& model, const StateVector& x, Linearization& at, ResidualMatrix& noise) {
  { model.rows() } -> std::convertible_to<int>;
  {model.noise(noise)};                              ///< covariance of the residual, rows x rows
  { model.linearize(x, at) } -> std::same_as<bool>;  ///< false: no finite solution at x
};

/// A model whose rows come in blocks that fail together, one a sensor: needed for heavy tails.
template <class M>
concept BlockModel = MeasurementModel<M> && requires(const M& model) {
  { model.block_end(0) } -> std::convertible_to<int>;  ///< row behind the block that row 0 belongs to
};

/// Mean and covariance.
struct Gaussian {
  StateVector mean;
  StateMatrix covariance;
};

enum class Damping {
  kLevenbergMarquardt,  ///< the cost falls with every step
  kNone,                ///< the paper's iteration, section 3.3.1: full Gauss-Newton steps; diverges where it is far off
};

struct UpdateOptions {
  int max_iterations = 15;       ///< steps tried; each costs one evaluation; range [1, 100]
  double step_tolerance = 2e-2;  ///< converged when so far from the maximum at most, in posterior sigmas; range (0, 1]
  Damping damping = Damping::kLevenbergMarquardt;
  double tail_degrees = 0.0;  ///< nu of a Student t tail, block by block; 0: Gaussian; otherwise range [1, 100]
  /// Where the steps so far promise no lower cost than this, the rest is spared: kNotConverged.
  double hopeless_cost = std::numeric_limits<double>::infinity();
  int nuisance_states = 0;  ///< the last so many states are parameters: their prior counts as data, not as prediction
};

enum class UpdateStatus {
  kConverged,
  kReseeded,      ///< converged, from a seed: not where the search began
  kAmbiguous,     ///< converged; another minimum explains the data as well
  kNotConverged,  ///< iterations ran out; the posterior is the last iterate, where damped the best one
  kFailed,        ///< no finite linearization where it began, or a covariance lost definiteness; posterior = prior
};

/// The mean can be relied on.
constexpr bool converged(UpdateStatus status) { return status <= UpdateStatus::kAmbiguous; }

/// The straight line for h that a posterior follows from: r(x) = residual - J (x - x0), up to N(0, R + more_noise).
struct UpdateLine {
  StateVector x0;
  Linearization at_x0;
  ResidualMatrix more_noise;  ///< empty: none
};

struct Update {
  UpdateStatus status = UpdateStatus::kFailed;
  Gaussian posterior;
  double chi_square = 0.0;  ///< twice the MAP cost at the posterior; for a linear model nu^T S^-1 nu, the NIS
  /// r^T R^-1 r, post-fit, and the cost of the nuisance states: the share of it that is not the prediction's, where the
  /// noise is Gaussian.
  double residual_chi_square = 0.0;
  /// (x_data - x_prior)^T (P_data + P_prior)^-1 (x_data - x_prior), linearised: chi-square, a degree a state that is
  /// not a nuisance.
  double surprise = 0.0;
  int rows = 0;
  int evaluations = 0;        ///< of the model
  ResidualVector innovation;  ///< residual where the search began: at the prior mean, unless told otherwise
  /// At the posterior mean; for an iterated update as the line has it, with the last Jacobian.
  Linearization at;
  UpdateLine line;  ///< what a linear filter makes the same posterior of
};

}  // namespace palpate
