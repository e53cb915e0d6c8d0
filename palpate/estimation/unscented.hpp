// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cassert>
#include <palpate/estimation/kalman.hpp>

/// Square-root unscented Kalman update. It sees the model over the whole spread of the prior instead of through its
/// tangent at the mean: nearer and less sure than the extended update's single step. Where the noise is small against
/// that spread, the iterated update is nearer still. No allocation, no exception.
namespace palpate {

namespace detail {

/// h as a straight line through the prior's sigma points: r(x0 + L z) = nu - G z - E w, z and w ~ N(0, I).
struct Regression {
  ResidualVector nu;  ///< mean residual
  JacobianMatrix G;   ///< slope, m x n
  JacobianMatrix E;   ///< what is not straight about h, m x n
};

/// The transform with alpha = 1, kappa = 0: x0 +- sqrt(n) L e_i, all weights 1 / 2n, none at the centre. Only then is
/// no weight negative for any n; at n = 3 the points have the fourth moment of a normal distribution as well. With
/// the residuals r_i+, r_i- of a pair, half their sum p_i and half their difference d_i,
///
///   nu = mean p_i,   G_i = -d_i / sqrt(n),   E_i = (nu - p_i) / sqrt(n):   S_xy = L G^T,  S_yy = G G^T + E E^T + R.
///
/// Turning each pair's two columns by 45 degrees into G_i and E_i leaves S_yy as it is and splits off the columns that
/// x has no part in. Residuals may be averaged where measurements may not: on a manifold they are tangent vectors.
/// False where the model has no finite answer at a point.
template <MeasurementModel Model>
bool regress(Model& model, const StateVector& mean, const StateMatrix& L, Update& out, Regression& line) {
  const Eigen::Index n = mean.size();
  const double spread = std::sqrt(static_cast<double>(n));
  line.nu.setZero(out.rows);
  line.G.resize(out.rows, n);
  line.E.resize(out.rows, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (const double side : {1.0, -1.0}) {
      ++out.evaluations;
      if (!model.linearize(mean + side * spread * L.col(i), out.at) || !out.at.residual.allFinite()) return false;
      assert(out.at.residual.size() == out.rows);
      if (side > 0.0) {
        line.G.col(i) = -0.5 / spread * out.at.residual;
        line.E.col(i) = -0.5 / spread * out.at.residual;
      } else {
        line.G.col(i) += 0.5 / spread * out.at.residual;
        line.E.col(i) -= 0.5 / spread * out.at.residual;
      }
    }
    line.nu -= line.E.col(i) / spread;
  }
  line.E.colwise() += line.nu / spread;
  return true;
}

/// z ~ N(mean, T T^T) after the update; T upper triangular.
struct WhitenedPosterior {
  StateVector mean;
  StateMatrix T;
  StateMatrix information;  ///< R_zz^T R_zz
  double chi_square = 0.0;  ///< nu^T S_yy^-1 nu
};

/// The update as least squares in the whitened unknowns (w, z), with R = W W^T and everything of `line` times W^-1:
///
///   | W^-1 nu |   | W^-1 E  W^-1 G |           QR, w eliminated first:      | R_ww  R_wz | q_w |
///   |    0    | = |   I       0    | (w, z)    ------------------------>    |       R_zz | q_z |
///   |    0    |   |   0       I    |                                       |            | q_r |
///
///   z+ = R_zz^-1 q_z,   T = R_zz^-1,   nu^T S_yy^-1 nu = |q_r|^2
///
/// R_zz^T R_zz = I + G^T (R + E E^T)^-1 G: its diagonal is at least 1, so nothing is ever divided by little, and
/// nothing is ever subtracted from a covariance. Source: array form of the covariance update as a least-squares problem
/// (Bierman 1977, chapter IV; Kailath, Sayed, Hassibi 2000, chapter 12), here for the sigma points' regression.
void solve_whitened(const Regression& line, WhitenedPosterior& out);

/// Prior and noise, factored, and the line through the sigma points, which make the posterior.
class SigmaPoints {
 public:
  /// The prior must outlive it. False from definite() where a covariance is not.
  SigmaPoints(const ResidualMatrix& noise, const Gaussian& prior);
  bool definite() const { return definite_; }
  const StateMatrix& L() const { return L_; }

  /// Fills `out` but for the residual at the posterior mean; false, and `out` without a posterior, where it overflows.
  bool conclude(Regression& line, int nuisance_states, Update& out);
  double residual_chi_square(const ResidualVector& residual, int nuisance_states) const;

 private:
  const Gaussian& prior_;
  Eigen::LLT<ResidualMatrix> W_;
  Eigen::LLT<StateMatrix> L_factor_;
  StateMatrix L_;
  WhitenedPosterior z_;
  bool definite_ = false;
};

}  // namespace detail

/// Unscented Kalman update. Sigma points, weights and equations: detail::regress, detail::solve_whitened.
///
/// Fills `out` as extended_update() does, but: `innovation` is the mean residual of the sigma points, and `chi_square`
/// nu^T S_yy^-1 nu with it. The covariance is symmetric, and its Cholesky factorisation succeeds.
/// kFailed, posterior = prior: R or P is not positive definite, the model has no finite answer at a sigma point, or the
/// result overflows. kNotConverged: the posterior stands, but the model has no finite answer at its mean, and `at` is
/// not to be used.
/// Cost: 2 n + 1 evaluations of the model (n states; the last one for the post-fit residual) and one QR of
/// (m + 2 n) x 2 n. Source: Julier and Uhlmann 2004; square-root form after van der Merwe and Wan 2001, whose downdates
/// the weights make needless.
/// `nuisance_states`: as UpdateOptions.
template <MeasurementModel Model>
void unscented_update(Model& model, const Gaussian& prior, Update& out, int nuisance_states = 0) {
  detail::begin(model.rows(), prior, out);
  ResidualMatrix noise;
  model.noise(noise);
  detail::SigmaPoints points(noise, prior);
  detail::Regression line;
  if (!points.definite() || !detail::regress(model, prior.mean, points.L(), out, line)) return;
  if (!points.conclude(line, nuisance_states, out)) return;
  ++out.evaluations;
  out.status = UpdateStatus::kNotConverged;
  if (!model.linearize(out.posterior.mean, out.at) || !out.at.residual.allFinite()) return;
  out.residual_chi_square = points.residual_chi_square(out.at.residual, nuisance_states);
  out.status = UpdateStatus::kConverged;
}

}  // namespace palpate
