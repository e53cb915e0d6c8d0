// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <palpate/observer/uncertainty.hpp>

namespace palpate {

namespace {

// A frame hides the axial force where it knows it only to a tenth of the buckling load, and several times worse than
// the forces across; those it hides where half a buckling load is not told.
constexpr double kWeakShare = 0.1, kWeakRatio = 6.0, kLateralShare = 0.5;
constexpr double kBlindShare = 0.6;     // of the buckling load: from there on the axial force is not asked for
constexpr double kStraight_rad = 0.35;  // tip against clamp
constexpr double kNoWiser = 0.9;        // of the prior's sigma

UncertaintySource source_of(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::kLogStiffness:
    case ParameterKind::kStiffnessRate:
      return UncertaintySource::kStiffness;
    case ParameterKind::kPrecurvature:
      return UncertaintySource::kPrecurvature;
    case ParameterKind::kTendonScale:
    case ParameterKind::kTendonMoment:
      return UncertaintySource::kTendon;
    case ParameterKind::kBasePosition:
    case ParameterKind::kBaseRotation:
      return UncertaintySource::kBase;
    case ParameterKind::kMountPosition:
      return UncertaintySource::kMounting;
    case ParameterKind::kSensorPosition:
    case ParameterKind::kSensorRotation:
      return UncertaintySource::kBias;
  }
  return UncertaintySource::kNoise;
}

const Section& first_flexible(const Rod& rod) {
  const auto section =
      std::find_if(rod.sections.begin(), rod.sections.end(), [](const Section& s) { return !s.rigid; });
  return section == rod.sections.end() ? rod.sections.front() : *section;
}

double buckling_load_N(const Rod& rod) {
  const Stiffness& K = first_flexible(rod).stiffness_Nm2;
  const double L = rod.length_m();
  return std::numbers::pi * std::numbers::pi * 0.5 * (K(0) + K(1)) / (4.0 * L * L);
}

}  // namespace

ForceUncertainty::ForceUncertainty(const Catheter& catheter, const ObserverOptions& options,
                                   const UncertainParameters& parameters)
    : catheter_(catheter),
      parameters_(parameters),
      force_sigma_N_(options.initial_force_sigma_N),
      buckling_N_(buckling_load_N(catheter.rod)),
      force_exponents_(3, parameters.size()),
      work_(3 + parameters.size(), 3 + parameters.size()) {
  for (int i = 0; i < parameters.size(); ++i) force_exponents_.col(i) = force_exponent(parameters.all[i]);
  for (const bool estimated : {false, true})
    for (std::size_t source = 1; source < kUncertaintySources; ++source) {
      Group group{static_cast<UncertaintySource>(source), {}};
      for (int i = 0; i < parameters.size(); ++i)
        if (parameters.all[i].estimated == estimated && source_of(parameters.all[i].kind) == group.source)
          group.members.push_back(i);
      if (!group.members.empty()) groups_.push_back(std::move(group));
    }
  for (int i = 0; i < parameters.size(); ++i)
    if (parameters.all[i].estimated && parameters.all[i].kind != ParameterKind::kStiffnessRate) estimated_.push_back(i);
  for (int i = 0; i < parameters.size(); ++i)
    if (!parameters.all[i].estimated && parameters.all[i].memory_s > 0.0) lasting_.push_back(i);
  prior_ = make_prior();
}

ParameterPrior ForceUncertainty::make_prior() const {
  const int q = parameters_.size(), rate = parameters_.find(ParameterKind::kStiffnessRate, 0);
  ParameterPrior prior{.covariance = parameters_.covariance,
                       .memory_s = Eigen::VectorXd(q),
                       .drive = Eigen::VectorXd(q),
                       .rate = Eigen::VectorXi::Constant(q, -1),
                       .estimated = Eigen::Array<bool, Eigen::Dynamic, 1>(q),
                       .force_exponents = force_exponents_};
  for (int i = 0; i < q; ++i) {
    const UncertainParameter& p = parameters_.all[i];
    prior.memory_s(i) = p.memory_s;
    prior.drive(i) = p.drive;
    prior.estimated(i) = p.estimated;
    if (p.kind == ParameterKind::kLogStiffness && p.estimated) prior.rate(i) = rate;
  }
  return prior;
}

Vector3d ForceUncertainty::force_scale(const Belief& belief) const {
  const Vector3d log_scale = force_exponents_.lazyProduct(belief.parameters);
  return log_scale.array().exp();
}

Vector3d ForceUncertainty::followed(const Vector3d& force_tip_N, const Belief& belief) const {
  return force_tip_N.cwiseQuotient(force_scale(belief));
}

/// Forces that are small against the buckling load from the outset have a straight line's effect, however weak.
double ForceUncertainty::weak_force_N() const {
  const double weak_N = kBlindShare * buckling_N_;
  return force_sigma_N_ > weak_N ? weak_N : std::numeric_limits<double>::infinity();
}

SigmaBudget ForceUncertainty::budget(const ComponentRow& reported, const Belief& belief) {
  SigmaBudget out;
  out.fill(Vector3d::Zero());
  const Eigen::Index q = parameters_.size();
  Eigen::MatrixXd& P = work_;
  const ForceGaussian followed = force_of(reported, belief.motion);
  P.topLeftCorner<3, 3>() = followed.covariance_N2;
  if (q > 0) {
    const ParameterCross cross = map_times(reported, belief.cross);
    const ForceGaussian force = in_newtons(prior_, followed, cross, belief.parameters, belief.parameter_covariance);
    P.topLeftCorner<3, 3>() = force.covariance_N2;
    const ParameterCross by_parameters = force.mean_N.asDiagonal() * force_exponents_;
    P.topRightCorner(3, q) = force_scale(belief).asDiagonal() * cross;
    P.topRightCorner(3, q) += by_parameters.lazyProduct(belief.parameter_covariance);
    P.bottomLeftCorner(q, 3) = P.topRightCorner(3, q).transpose();
    P.bottomRightCorner(q, q) = belief.parameter_covariance;
  }
  for (const Group& group : groups_) {
    Vector3d& share = out[static_cast<std::size_t>(group.source)];
    // One scalar of the group at a time: conditioning is a rank-one downdate, and the shares add up.
    for (const int member : group.members) {
      const Eigen::Index k = 3 + member;
      const double variance = P(k, k);
      if (!(variance > 0.0)) continue;
      Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3 + kMaxParameters, 1> column = P.col(k);
      share += column.head<3>().cwiseAbs2() / variance;
      P.noalias() -= (column / variance).lazyProduct(column.transpose());
    }
  }
  for (Vector3d& share : out) share = share.cwiseMax(0.0).cwiseSqrt();
  out[0] = P.diagonal().head<3>().cwiseMax(0.0).cwiseSqrt();
  return out;
}

SigmaBudget ForceUncertainty::budget(const SmoothedFrame& frame) const {
  SigmaBudget out;
  out.fill(Vector3d::Zero());
  Vector3d rest = frame.force.covariance_N2.diagonal();
  const Eigen::MatrixXd DC = frame.force_by_considered * prior_.covariance(lasting_, lasting_);
  for (std::size_t k = 0; k < lasting_.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const Vector3d share = DC.col(column).cwiseProduct(frame.force_by_considered.col(column));
    out[static_cast<std::size_t>(source_of(parameters_.all[lasting_[k]].kind))] += share;
    rest -= share;
  }
  out[0] = rest;
  for (Vector3d& share : out) share = share.cwiseMax(0.0).cwiseSqrt();
  return out;
}

ShaftEstimate ForceUncertainty::shaft(const SmoothedFrame& frame) const {
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(parameters_.size());
  Eigen::MatrixXd covariance = parameters_.covariance;
  int next = 0;
  std::vector<int> all;
  for (int i = 0; i < parameters_.size(); ++i)
    if (parameters_.all[i].estimated) {
      parameters(i) = frame.parameters(next++);
      all.push_back(i);
    }
  covariance(all, all) = frame.parameter_covariance;
  return shaft(parameters, covariance);
}

ShaftEstimate ForceUncertainty::shaft(const Eigen::VectorXd& parameters, const Eigen::MatrixXd& covariance) const {
  const Section& section = first_flexible(catheter_.rod);
  ShaftEstimate out;
  Vector3d log_stiffness = Vector3d::Zero(), log_sigma = Vector3d::Zero();
  out.precurvature_per_m = section.precurvature_per_m;
  out.precurvature_sigma_per_m = catheter_.precurvature_sigma_per_m;
  log_sigma.setConstant(catheter_.stiffness_sigma_fraction);
  for (int i = 0; i < parameters_.size(); ++i) {
    const UncertainParameter& p = parameters_.all[i];
    const double sigma = std::sqrt(covariance(i, i));
    if (p.kind == ParameterKind::kLogStiffness) log_stiffness(p.axis) = parameters(i), log_sigma(p.axis) = sigma;
    if (p.kind == ParameterKind::kPrecurvature) {
      out.precurvature_per_m(p.axis) += parameters(i);
      out.precurvature_sigma_per_m(p.axis) = sigma;
    }
  }
  const Stiffness& K = section.stiffness_Nm2;
  out.stiffness_Nm2 = K.cwiseProduct(log_stiffness.array().exp().matrix());
  const int first = parameters_.find(ParameterKind::kLogStiffness, 0);
  if (parameters_.torsion_tied && first >= 0) {
    const Eigen::Vector2d share = out.stiffness_Nm2.head<2>() / out.stiffness_Nm2.head<2>().sum();
    out.stiffness_Nm2(2) = K(2) * out.stiffness_Nm2.head<2>().sum() / (K(0) + K(1));
    log_sigma(2) = std::sqrt(share.dot(covariance.block<2, 2>(first, first) * share));
  }
  out.stiffness_sigma_Nm2 = out.stiffness_Nm2.cwiseProduct(log_sigma);
  return out;
}

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
  const Eigen::SelfAdjointEigenSolver<StateMatrix> spectrum(information);
  const double least = spectrum.eigenvalues()(0);
  out.weakest_sigmas = least > 0.0 ? 1.0 / std::sqrt(least) : std::numeric_limits<double>::infinity();
  const StateVector v = spectrum.eigenvectors().col(0);
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
