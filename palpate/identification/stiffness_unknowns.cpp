// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <palpate/identification/stiffness_unknowns.hpp>

namespace palpate::stiffness {

namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// Of (position, rotation) of the clamp in base axes, as BaseRegistration orders them.
/// Of shift and turn of the clamp. Where it is tracked the file speaks of its sensor's mounting, about the sensor,
/// whose bias adds to it: shift of the clamp = rho + p x theta.
Matrix6d clamp_covariance(const BaseRegistration& base) {
  Eigen::Matrix<double, 6, 1> sigma;
  sigma << Vector3d::Constant(base.position_sigma_m), Vector3d::Constant(base.rotation_sigma_rad);
  Matrix6d C = base.covariance ? *base.covariance : Matrix6d(sigma.cwiseAbs2().asDiagonal());
  if (!base.tracked) return C;
  C.diagonal().head<3>().array() += base.sensor.bias_m * base.sensor.bias_m / 3.0;
  C.diagonal().tail<3>().array() += base.sensor.bias_rad * base.sensor.bias_rad / 3.0;
  Matrix6d about_clamp = Matrix6d::Identity();
  about_clamp.topRightCorner<3, 3>() = hat(base.sensor.T_local_sensor.p);
  return about_clamp * C * about_clamp.transpose();
}

/// Root of the prior's covariance, turn, shift, precurvature; what is exactly known has no column. The units differ, so
/// the roots are taken of the correlations.
Eigen::Matrix<double, 9, Eigen::Dynamic> root_of_prior(const Catheter& catheter) {
  const Matrix6d clamp = clamp_covariance(catheter.base);
  Matrix9d C = Matrix9d::Zero();
  C.topLeftCorner<3, 3>() = clamp.bottomRightCorner<3, 3>();
  C.block<3, 3>(3, 3) = clamp.topLeftCorner<3, 3>();
  C.block<3, 3>(0, 3) = clamp.bottomLeftCorner<3, 3>();
  C.block<3, 3>(3, 0) = clamp.topRightCorner<3, 3>();
  C.bottomRightCorner<3, 3>() = catheter.precurvature_sigma_per_m.cwiseAbs2().asDiagonal();
  const Eigen::Matrix<double, 9, 1> sigma = C.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::Matrix<double, 9, 1> per_sigma = (sigma.array() > 0.0).select(sigma.cwiseInverse(), 0.0);
  const Eigen::SelfAdjointEigenSolver<Matrix9d> eigen(per_sigma.asDiagonal() * C * per_sigma.asDiagonal());
  Eigen::Matrix<double, 9, Eigen::Dynamic> root(9, 0);
  for (int i = 0; i < 9; ++i) {
    if (eigen.eigenvalues()(i) < 1e-9) continue;
    root.conservativeResize(9, root.cols() + 1);
    root.rightCols<1>() = std::sqrt(eigen.eigenvalues()(i)) * sigma.cwiseProduct(eigen.eigenvectors().col(i));
  }
  return root;
}

Rod with_torsion_by_poisson(Rod rod, const std::optional<double>& poisson_ratio) {
  if (poisson_ratio)
    for (Section& section : rod.sections)
      section.stiffness_Nm2(2) =
          torsional_stiffness_Nm2(section.stiffness_Nm2(0), section.stiffness_Nm2(1), *poisson_ratio);
  return rod;
}

}  // namespace

Unknowns::Unknowns(const Catheter& catheter, const StiffnessOptions& options)
    : options_(options), described_(catheter.rod), prior_root_(root_of_prior(catheter)) {
  using Kind = StiffnessOptions::Unknowns;
  if (options.unknowns == Kind::kBending) described_ = with_torsion_by_poisson(described_, options.poisson_ratio);
  const auto flexible = std::find_if(described_.sections.begin(), described_.sections.end(),
                                     [](const Section& section) { return !section.rigid; });
  reference_Nm2_ = flexible->stiffness_Nm2;
  if (options.unknowns == Kind::kScale) {
    stiffnesses_.push_back({"stiffness scale", 1.0});
  } else {
    stiffnesses_.push_back({"EI1", reference_Nm2_(0)});
    stiffnesses_.push_back({"EI2", reference_Nm2_(1)});
  }
  if (options.unknowns == Kind::kBendingAndTorsion) stiffnesses_.push_back({"GJ", reference_Nm2_(2)});
  if (options.free_shear) stiffnesses_.push_back({"shear stiffness", described_.shear_stiffness_N});
}

int Unknowns::free_stiffnesses() const {
  return static_cast<int>(
      std::count_if(stiffnesses_.begin(), stiffnesses_.end(), [](const auto& s) { return s.free; }));
}

int Unknowns::index_of(int stiffness) const {
  if (!stiffnesses_[stiffness].free) return -1;
  return static_cast<int>(
      std::count_if(stiffnesses_.begin(), stiffnesses_.begin() + stiffness, [](const auto& s) { return s.free; }));
}

double Unknowns::log_of(int stiffness, const Eigen::VectorXd& z) const {
  const int i = index_of(stiffness);
  return i < 0 ? 0.0 : z(i);
}

/// Logarithm of (EI1 + EI2) over that described, and its derivatives by the logarithms of EI1 and EI2.
Vector3d Unknowns::bending_shares(const Eigen::VectorXd& z, double& log_sum) const {
  const double EI1 = reference_Nm2_(0) * std::exp(log_of(0, z)), EI2 = reference_Nm2_(1) * std::exp(log_of(1, z));
  log_sum = std::log((EI1 + EI2) / (reference_Nm2_(0) + reference_Nm2_(1)));
  return {EI1 / (EI1 + EI2), EI2 / (EI1 + EI2), 0.0};
}

Numbers Unknowns::numbers(const Eigen::VectorXd& z) const {
  Numbers q = Numbers::Zero();
  double common = 0.0;
  if (options_.unknowns == StiffnessOptions::Unknowns::kScale) {
    common = log_of(0, z);
    q.segment<3>(kLogStiffness).setConstant(common);
  } else {
    bending_shares(z, common);
    const bool torsion = options_.unknowns == StiffnessOptions::Unknowns::kBendingAndTorsion;
    q.segment<3>(kLogStiffness) << log_of(0, z), log_of(1, z), torsion ? log_of(2, z) : common;
  }
  const int last = static_cast<int>(stiffnesses_.size()) - 1;
  if (described_.shears()) q(kLogShear) = options_.free_shear ? log_of(last, z) : common;
  q.segment<9>(kTurn) = prior_root_ * z.tail(nuisances());
  return q;
}

NumbersByUnknown Unknowns::derivative(const Eigen::VectorXd& z) const {
  using Row = Eigen::RowVectorXd;
  const int n = size(), last = static_cast<int>(stiffnesses_.size()) - 1;
  const auto unit = [&](int stiffness) -> Row {
    const int i = index_of(stiffness);
    return i < 0 ? Row(Row::Zero(n)) : Row(Row::Unit(n, i));
  };
  NumbersByUnknown d = NumbersByUnknown::Zero(kNumbers, n);
  Row common = unit(0);
  if (options_.unknowns == StiffnessOptions::Unknowns::kScale) {
    for (int i = 0; i < 3; ++i) d.row(kLogStiffness + i) = common;
  } else {
    double log_sum = 0.0;
    const Vector3d share = bending_shares(z, log_sum);
    common = share(0) * unit(0) + share(1) * unit(1);
    const bool torsion = options_.unknowns == StiffnessOptions::Unknowns::kBendingAndTorsion;
    d.row(kLogStiffness) = unit(0);
    d.row(kLogStiffness + 1) = unit(1);
    d.row(kLogStiffness + 2) = torsion ? unit(2) : common;
  }
  if (described_.shears()) d.row(kLogShear) = options_.free_shear ? unit(last) : common;
  d.block(kTurn, n - nuisances(), 9, nuisances()) = prior_root_;
  return d;
}

Numbers Unknowns::scaled(double log_scale) const {
  Numbers q = Numbers::Zero();
  q.segment<3>(kLogStiffness).setConstant(log_scale);
  if (described_.shears()) q(kLogShear) = log_scale;
  return q;
}

Eigen::VectorXd Unknowns::start(double log_scale) const {
  Eigen::VectorXd z = Eigen::VectorXd::Zero(size());
  z.head(free_stiffnesses()).setConstant(log_scale);
  return z;
}

Rod Unknowns::identified(const Eigen::VectorXd& z) const {
  const Numbers q = numbers(z);
  Rod rod = described_;
  const Vector3d factor = q.segment<3>(kLogStiffness).array().exp();
  for (Section& section : rod.sections)
    if (!section.rigid) section.stiffness_Nm2 = section.stiffness_Nm2.cwiseProduct(factor);
  rod.shear_stiffness_N *= std::exp(q(kLogShear));
  rod.axial_stiffness_N *= std::exp(q(kLogShear));
  return rod;
}

}  // namespace palpate::stiffness
