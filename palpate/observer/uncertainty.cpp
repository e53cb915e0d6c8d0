// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <numbers>
#include <palpate/observer/uncertainty.hpp>

namespace palpate {

namespace {

constexpr double kBlindShare = 0.4;  // of the buckling load: from there on the axial force is not asked for

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

double buckling_load_N(const Rod& rod) {
  const Stiffness& K = rod.first_flexible().stiffness_Nm2;
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
  const Section& section = catheter_.rod.first_flexible();
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

}  // namespace palpate
