// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <cmath>
#include <palpate/estimation/belief.hpp>

namespace palpate {

namespace {

/// exp(-dt / memory): 1 for a constant, 0 for what is drawn anew (also over no time at all).
double kept(double dt_s, double memory_s) { return memory_s > 0.0 ? std::exp(-dt_s / memory_s) : 0.0; }

using ParameterColumn = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxParameters, 1>;

void symmetrise(Eigen::Ref<Eigen::MatrixXd> P) {
  for (Eigen::Index j = 0; j < P.cols(); ++j)
    for (Eigen::Index i = j + 1; i < P.rows(); ++i) P(i, j) = P(j, i) = 0.5 * (P(i, j) + P(j, i));
}

}  // namespace

void BeliefModel::initial(const MotionModel& motion, Belief& belief) const {
  motion.initial(belief.motion);
  belief.parameters.setZero(parameters());
  belief.cross.setZero(motion.states(), parameters());
  belief.parameter_covariance = prior_.covariance;
}

void BeliefModel::predict(const MotionModel& motion, const MotionStep& step, Belief& belief) const {
  motion.predict(step, belief.motion);
  ComponentMatrix a;
  motion.transition(step, a);
  const Eigen::MatrixXd& C = prior_.covariance;
  for (Eigen::Index j = 0; j < parameters(); ++j) {
    const double phi = kept(step.dt_s, prior_.memory_s(j));
    belief.parameters(j) *= phi;
    MotionVector column = belief.cross.col(j);
    apply_transition(a, column);
    belief.cross.col(j) = phi * column;
    for (Eigen::Index i = 0; i < parameters(); ++i) {
      const double both = phi * kept(step.dt_s, prior_.memory_s(i));
      belief.parameter_covariance(i, j) = both * belief.parameter_covariance(i, j) + (1.0 - both) * C(i, j);
    }
  }
  wander(step.dt_s, belief);
  hold_within_prior(belief);
}

/// Rates move their parameters (a shear of the state), white noise drives them.
void BeliefModel::wander(double dt_s, Belief& belief) const {
  Eigen::MatrixXd& P = belief.parameter_covariance;
  for (Eigen::Index i = 0; i < parameters(); ++i) {
    const Eigen::Index rate = prior_.rate(i);
    if (rate >= 0) {
      belief.parameters(i) += dt_s * belief.parameters(rate);
      belief.cross.col(i) += dt_s * belief.cross.col(rate);
      P.row(i) += dt_s * P.row(rate);
      P.col(i) += dt_s * P.col(rate);
    }
    P(i, i) += prior_.drive(i) * prior_.drive(i) * dt_s;
  }
}

void BeliefModel::hold_within_prior(Belief& belief) const {
  Eigen::MatrixXd& P = belief.parameter_covariance;
  for (Eigen::Index i = 0; i < parameters(); ++i) {
    const double variance = P(i, i), limit = prior_.covariance(i, i);
    if (!prior_.estimated(i) || !(variance > limit)) continue;
    const double share = (variance - limit) / (variance * variance), shift = belief.parameters(i) * variance * share;
    const ParameterColumn with_parameters = P.col(i);
    const MotionVector with_motion = belief.cross.col(i);
    belief.motion.mean -= shift / variance * with_motion;
    belief.motion.covariance -= share * with_motion.lazyProduct(with_motion.transpose());
    belief.cross -= share * with_motion.lazyProduct(with_parameters.transpose());
    for (Eigen::Index j = 0; j < parameters(); ++j) {
      if (prior_.estimated(j)) belief.parameters(j) -= shift / variance * with_parameters(j);
      for (Eigen::Index k = 0; k < parameters(); ++k)
        if (prior_.estimated(j) || prior_.estimated(k)) P(j, k) -= share * with_parameters(j) * with_parameters(k);
    }
  }
}

/// S, nu and the gains. False where S is not positive definite or nu not finite.
bool BeliefModel::weigh(const ComponentRow& seen, const FrameLine& line, const Belief& belief, Correction& c) const {
  const auto& J_F = line.by_force;
  const auto& J_p = line.by_parameters;
  const bool any = parameters() > 0;
  c.motion_covariance = times_map(belief.motion.covariance, seen).lazyProduct(J_F.transpose());
  c.parameter_covariance.setZero(parameters(), line.residual.size());
  c.shift = line.residual + J_F * (line.force_N - force_mean(seen, belief.motion.mean));
  if (any) {
    c.motion_covariance += belief.cross.lazyProduct(J_p.transpose());
    c.parameter_covariance = map_times(seen, belief.cross).transpose().lazyProduct(J_F.transpose());
    c.parameter_covariance += belief.parameter_covariance.lazyProduct(J_p.transpose());
    const ParameterColumn moved = line.parameters - belief.parameters;  // as an operand, it would be put on the heap
    c.shift += J_p.lazyProduct(moved);
  }
  ResidualMatrix S = line.noise;
  S += J_F.lazyProduct(map_times(seen, c.motion_covariance));
  if (any) S += J_p.lazyProduct(c.parameter_covariance);
  S = (0.5 * (S + S.transpose())).eval();
  c.innovation.compute(S);
  if (c.innovation.info() != Eigen::Success || !c.shift.allFinite()) return false;

  c.motion_gain = c.innovation.solve(c.motion_covariance.transpose()).transpose();
  c.motion_surplus.setZero(c.motion_gain.rows(), c.motion_gain.cols());
  if (!line.hidden.isZero(0.0)) {
    for (Eigen::Index k = 0; k < seen.size(); ++k) {
      auto gain = c.motion_gain.block(3 * k, 0, 3, line.hiding_rows);
      gain -= (line.hidden * gain).eval();
    }
    c.motion_surplus = c.motion_gain.lazyProduct(S) - c.motion_covariance;
  }
  c.parameter_gain = c.innovation.solve(c.parameter_covariance.transpose()).transpose();
  for (Eigen::Index i = 0; i < parameters(); ++i)
    if (!prior_.estimated(i)) c.parameter_gain.row(i).setZero();
  return true;
}

bool BeliefModel::update(const ComponentRow& seen, const FrameLine& line, Belief& belief,
                         Correction& correction) const {
  Correction& c = correction;
  c.rows = 0;
  if (!weigh(seen, line, belief, c)) return false;
  const MotionMatrix& before = belief.motion.covariance;
  MotionMatrix P = before;
  P -= c.motion_gain.lazyProduct(c.motion_covariance.transpose());
  P += c.motion_surplus.lazyProduct(c.motion_gain.transpose());
  P = (0.5 * (P + P.transpose())).eval();
  // Written so that NaN is refused as well. A component known exactly may keep its zero.
  const bool sound = ((P.diagonal().array() > 0.0) || (before.diagonal().array() == 0.0)).all();
  if (!sound) return false;
  belief.motion.covariance = P;
  belief.motion.mean += c.motion_gain.lazyProduct(c.shift);
  c.by_force = line.by_force;
  c.by_parameters = line.by_parameters;
  c.rows = line.residual.size();
  if (parameters() > 0) correct_parameters(c, belief);
  return true;
}

/// x_e <- x_e + K_e nu, P_ee <- P_ee - K_e S K_e^T, P_ec <- P_ec - K_e cov(p_c, nu)^T.
void BeliefModel::correct_parameters(const Correction& c, Belief& belief) const {
  belief.parameters += c.parameter_gain.lazyProduct(c.shift);
  belief.cross -= c.motion_gain.lazyProduct(c.parameter_covariance.transpose());
  belief.cross += c.motion_surplus.lazyProduct(c.parameter_gain.transpose());
  for (Eigen::Index i = 0; i < parameters(); ++i) {
    if (!prior_.estimated(i)) continue;
    for (Eigen::Index j = 0; j < parameters(); ++j) {
      const double taken = c.parameter_gain.row(i).dot(c.parameter_covariance.row(j));
      belief.parameter_covariance(i, j) -= taken;
      if (!prior_.estimated(j)) belief.parameter_covariance(j, i) -= taken;
    }
  }
  symmetrise(belief.parameter_covariance);
}

void BeliefModel::see(const ComponentRow& seen, const Belief& belief, SeenBelief& out) {
  const Eigen::Index q = belief.parameters.size();
  const ForceGaussian force = force_of(seen, belief.motion);
  out.mean.resize(3 + q);
  out.covariance.resize(3 + q, 3 + q);
  out.mean.head<3>() = force.mean_N;
  out.covariance.topLeftCorner<3, 3>() = force.covariance_N2;
  if (q == 0) return;
  out.mean.tail(q) = belief.parameters;
  out.covariance.topRightCorner(3, q) = map_times(seen, belief.cross);
  out.covariance.bottomLeftCorner(q, 3) = out.covariance.topRightCorner(3, q).transpose();
  out.covariance.bottomRightCorner(q, q) = belief.parameter_covariance;
}

/// As within_belief(): F_i = 0 is measured with the noise that leaves the variance at limit^2.
void limit_force(double limit_N, SeenBelief& seen) {
  const double limit = limit_N * limit_N;
  for (int i = 0; i < 3; ++i) {
    const double variance = seen.covariance(i, i);
    if (!(variance > limit)) continue;
    const double share = (variance - limit) / (variance * variance), shift = seen.mean(i) * variance * share;
    for (Eigen::Index k = 0; k < seen.mean.size(); ++k) seen.mean(k) -= seen.covariance(k, i) / variance * shift;
    Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3 + kMaxParameters, 1> column = seen.covariance.col(i);
    seen.covariance -= share * column.lazyProduct(column.transpose());
  }
}

ForceGaussian in_newtons(const ParameterPrior& prior, const ForceGaussian& force, const ParameterCross& cross,
                         const Eigen::VectorXd& parameters, const Eigen::MatrixXd& parameter_covariance) {
  if (prior.force_exponents.cols() == 0 || prior.force_exponents.isZero(0.0)) return force;
  const Vector3d log_scale = prior.force_exponents.lazyProduct(parameters);
  const Vector3d scale = log_scale.array().exp();
  ForceGaussian out;
  out.mean_N = scale.cwiseProduct(force.mean_N);
  const ParameterCross by_parameters = out.mean_N.asDiagonal() * prior.force_exponents;
  const ParameterCross half = 0.5 * by_parameters.lazyProduct(parameter_covariance);
  const ParameterCross scaled = scale.asDiagonal() * cross;
  const Matrix3d side = (scaled + half).lazyProduct(by_parameters.transpose());
  out.covariance_N2 = scale.asDiagonal() * force.covariance_N2 * scale.asDiagonal();
  out.covariance_N2 += side + side.transpose();
  out.covariance_N2 = (0.5 * (out.covariance_N2 + out.covariance_N2.transpose())).eval();
  return out;
}

ForceLikelihood force_likelihood(const FrameLine& line, const ParameterPrior& prior, const Belief& belief) {
  ResidualMatrix white = line.noise, total = line.noise;
  ResidualVector r = line.residual + line.by_force * line.force_N;
  if (prior.size() > 0) {
    const ParameterColumn moved = line.parameters - belief.parameters;  // as an operand, it would be put on the heap
    r += line.by_parameters.lazyProduct(moved);
    const FrameLine::Rows<Eigen::Dynamic, kMaxParameters> JP =
        line.by_parameters.lazyProduct(belief.parameter_covariance);
    total += JP.lazyProduct(line.by_parameters.transpose());
    for (Eigen::Index i = 0; i < prior.size(); ++i)
      if (prior.memory_s(i) == 0.0)
        white += prior.covariance(i, i) * line.by_parameters.col(i) * line.by_parameters.col(i).transpose();
  }
  const Eigen::LLT<ResidualMatrix> factor(total);
  if (factor.info() != Eigen::Success) return {};
  const FrameLine::Rows<3> WJ = factor.solve(line.by_force);
  const Matrix3d N = line.by_force.transpose() * WJ;
  const Vector3d n = WJ.transpose() * r;
  if (prior.size() == 0) return {0.5 * (N + N.transpose()), n};

  const FrameLine::Rows<3> RWJ = white.lazyProduct(WJ);
  const Matrix3d M = WJ.transpose() * RWJ;
  Eigen::SelfAdjointEigenSolver<Matrix3d> spectrum;
  spectrum.compute(0.5 * (M + M.transpose()));
  const Vector3d& d = spectrum.eigenvalues();
  const Vector3d inverse = (d.array() > 1e-12 * d.cwiseAbs().maxCoeff()).select(d.cwiseInverse(), 0.0);
  const Matrix3d NM = N * spectrum.eigenvectors() * inverse.asDiagonal() * spectrum.eigenvectors().transpose();
  const Matrix3d information = NM * N.transpose();
  return {0.5 * (information + information.transpose()), NM * n};
}

}  // namespace palpate
