// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <palpate/observer/uncertainty.hpp>

/// What one frame tells of the force and of the estimated parameters, and what it does not.
namespace palpate {

namespace {

// A frame hides the axial force where it knows it only to a tenth of the buckling load, and several times worse than
// the forces across; those it hides where half a buckling load is not told.
constexpr double kWeakShare = 0.1, kWeakRatio = 6.0, kLateralShare = 0.5;
constexpr double kStraight_rad = 0.35;  // tip against clamp
constexpr double kNoWiser = 0.9;        // of the prior's sigma

struct Eigenpair {
  double value;
  StateVector vector;
};

template <class Matrix>
Eigenpair least_eigenpair(const StateMatrix& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Matrix> spectrum{Matrix(symmetric)};
  return {spectrum.eigenvalues()(0), spectrum.eigenvectors().col(0)};
}

}  // namespace

/// L^T J^T (R + J_c C_c J_c^T)^-1 J L with L the prior sigmas: 1 means that a frame knows as much as was known before
/// it.
StateMatrix ForceUncertainty::information(const FrameLine& line) const {
  const auto n = static_cast<Eigen::Index>(3 + estimated_.size());
  ResidualMatrix R = line.noise;
  JacobianMatrix J(line.residual.size(), n);
  J.leftCols<3>() = force_sigma_N_ * line.by_force;
  for (std::size_t k = 0; k < estimated_.size(); ++k)
    J.col(static_cast<Eigen::Index>(3 + k)) =
        std::sqrt(parameters_.covariance(estimated_[k], estimated_[k])) * line.by_parameters.col(estimated_[k]);
  for (int j = 0; j < parameters_.size(); ++j) {
    if (parameters_.all[j].estimated) continue;
    ResidualVector column = ResidualVector::Zero(R.rows());  // sum_i C_ij J_i
    for (int i = 0; i < parameters_.size(); ++i)
      if (!parameters_.all[i].estimated && parameters_.covariance(i, j) != 0.0)
        column += parameters_.covariance(i, j) * line.by_parameters.col(i);
    R.noalias() += column.lazyProduct(line.by_parameters.col(j).transpose());
  }
  R = (0.5 * (R + R.transpose())).eval();
  const Eigen::LLT<ResidualMatrix> factor(R);
  if (factor.info() != Eigen::Success) return StateMatrix::Zero(n, n);
  factor.matrixL().solveInPlace(J);
  return J.transpose().lazyProduct(J);
}

void ForceUncertainty::find_weakest(const StateMatrix& information, const Belief& belief, Observability& out) const {
  const Eigenpair weakest = information.rows() == 3 ? least_eigenpair<Matrix3d>(information)  // the usual case, quicker
                                                    : least_eigenpair<StateMatrix>(information);
  const StateVector& v = weakest.vector;
  out.weakest_sigmas = weakest.value > 0.0 ? 1.0 / std::sqrt(weakest.value) : std::numeric_limits<double>::infinity();
  const Vector3d scale = force_scale(belief), force_N = scale.cwiseProduct(belief.motion.mean.head<3>());
  out.weakest_force_N = force_sigma_N_ * scale.cwiseProduct(v.head<3>());
  for (std::size_t k = 0; k < estimated_.size(); ++k) {
    const UncertainParameter& p = parameters_.all[estimated_[k]];
    const double sigma = std::sqrt(parameters_.covariance(estimated_[k], estimated_[k]));
    Vector3d& part =
        p.kind == ParameterKind::kLogStiffness ? out.weakest_log_stiffness : out.weakest_precurvature_per_m;
    part(p.axis) = sigma * v(static_cast<Eigen::Index>(3 + k));
    out.weakest_force_N += part(p.axis) * force_exponent(p).cwiseProduct(force_N);
  }
}

/// Of the mean of log EI1 and log EI2.
double ForceUncertainty::scale_sigma(const Eigen::MatrixXd& covariance) const {
  const int first = parameters_.find(ParameterKind::kLogStiffness, 0);
  return first < 0 ? 0.0 : 0.5 * std::sqrt(covariance.block<2, 2>(first, first).sum());
}

Observability ForceUncertainty::observability(const FrameLine& line, const Belief& belief,
                                              const Matrix3d& R_base_tip) const {
  Observability out;
  const StateMatrix I = information(line);
  find_weakest(I, belief, out);
  // The force alone, stiffness and precurvature as they are believed to be.
  const Eigen::LLT<Matrix3d> force(Matrix3d(I.topLeftCorner<3, 3>()));
  const double infinity = std::numeric_limits<double>::infinity();
  Vector3d sigma = Vector3d::Constant(infinity);
  if (force.info() == Eigen::Success) sigma = force_sigma_N_ * force.solve(Matrix3d::Identity()).diagonal().cwiseSqrt();
  const double across = sigma.head<2>().maxCoeff();
  out.axial_force_hidden = !(sigma.z() < kWeakShare * buckling_N_) && !(sigma.z() < kWeakRatio * across);
  out.lateral_force_hidden = !(across < kLateralShare * buckling_N_);
  out.shaft_straight = R_base_tip(2, 2) > std::cos(kStraight_rad);

  const int stiffness = parameters_.find(ParameterKind::kLogStiffness, 0);
  if (stiffness >= 0 && parameters_.all[stiffness].estimated) {
    out.stiffness_scale_sigma = scale_sigma(belief.parameter_covariance);
    out.stiffness_scale_prior_sigma = std::sqrt(parameters_.covariance(stiffness, stiffness));
    out.stiffness_rests_on_prior = out.stiffness_scale_sigma > kNoWiser * out.stiffness_scale_prior_sigma;
  }
  const int bend = parameters_.find(ParameterKind::kPrecurvature, 0);
  if (bend >= 0 && parameters_.all[bend].estimated)
    out.precurvature_rests_on_prior =
        belief.parameter_covariance(bend, bend) > kNoWiser * kNoWiser * parameters_.covariance(bend, bend);
  return out;
}

}  // namespace palpate
