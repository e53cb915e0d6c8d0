// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <palpate/rod/relaxed_rod.hpp>

namespace palpate {

namespace {

using Columns = Eigen::Matrix<double, 3, RelaxedRod::kUnknowns>;

double mean_bending_stiffness(const Rod& rod) {
  double compliance = 0.0, flexible_m = 0.0;
  for (const Section& section : rod.sections) {
    if (section.rigid) continue;
    const double length_m = section.to_m - section.from_m;
    compliance += length_m * 2.0 / (section.stiffness_Nm2(0) + section.stiffness_Nm2(1));
    flexible_m += length_m;
  }
  return flexible_m > 0.0 ? flexible_m / compliance : 0.0;
}

}  // namespace

/// Where the integration stands: tip frame, tangents beside the value (rotation on the body side).
struct RelaxedRod::March {
  Matrix3d R = Matrix3d::Identity();
  Vector3d r = Vector3d::Zero();
  Vector3d rho = Vector3d::Zero();  ///< int_s^L r ds
  Columns d_R = Columns::Zero(), d_r = Columns::Zero();

  /// R exp(-u h): the frame `h` nearer to the clamp.
  void turn(const Vector3d& u, const Columns& d_u, double h) {
    const Vector3d w = -h * u;
    const Matrix3d E = exp_so3(w);
    R = R * E;
    d_R = (E.transpose() * d_R - h * right_jacobian(w) * d_u).eval();
  }
  /// A straight step of length h along the tangent of `middle`.
  void walk(const March& middle, double h) {
    rho += h * (r - 0.5 * h * middle.R.col(2));
    r -= h * middle.R.col(2);
    d_r -= h * middle.R * hat(-Vector3d::UnitZ()) * middle.d_R;
  }
};

RelaxedRod::Bending RelaxedRod::Cell::under(const TipLoad& load, const Vector3d& factor) const {
  if (rigid) return {Vector3d::Zero(), precurvature};
  const Vector3d changed = compliance.cwiseProduct(factor);
  return {changed, precurvature + load.precurvature_per_m + changed.cwiseProduct(load.tendon_couple_Nm)};
}

RelaxedRod::RelaxedRod(const Rod& rod, std::span<const double> arc_lengths_m)
    : contact_offset_m_(rod.contact_offset_m), length_m_(rod.length_m()), cell_m_(length_m_ / kCells) {
  Eigen::Matrix<double, kCells, kPowers> basis;
  for (int i = 0; i < kCells; ++i) {
    const double x = (i + 0.5) / kCells, s = length_m_ * (1.0 - x);
    const auto section = std::find_if(rod.sections.begin(), rod.sections.end() - 1,
                                      [s](const Section& candidate) { return s < candidate.to_m; });
    Cell& cell = cells_[i];
    cell.precurvature = section->precurvature_per_m;
    cell.rigid = section->rigid;
    if (!cell.rigid) {
      cell.compliance = section->stiffness_Nm2.cwiseInverse();
      for (int b = 0; b < kPowers; ++b) cell.powers(b) = std::pow(x, b + 1) / length_m_;
    }
    basis.row(i) = cell.powers.transpose();
  }
  Eigen::Matrix<double, kPowers, kPowers> normal = basis.transpose() * basis;
  normal.diagonal() *= 1.0 + 1e-9;  // a shaft that flexes in fewer cells than there are powers
  normal.diagonal().array() += 1e-30;
  projection_ = normal.ldlt().solve(basis.transpose());

  for (const double s : arc_lengths_m) {
    const double sigma = std::clamp(length_m_ - s, 0.0, length_m_);
    const int cell = std::min(static_cast<int>(sigma / cell_m_), kCells - 1);
    stations_.push_back({.cell = cell, .into_m = sigma - cell * cell_m_, .beyond_tip_m = std::max(s - length_m_, 0.0)});
  }
  buckling_force_N_ = std::numbers::pi * std::numbers::pi * mean_bending_stiffness(rod) / (4.0 * length_m_ * length_m_);
}

RelaxedRod::Shape RelaxedRod::make_shape() const {
  Shape shape;
  shape.curve.points.resize(stations_.size());
  shape.curve.tangents.resize(stations_.size());
  return shape;
}

/// mu = M + c x F - r x n + rho x g,  n = F + sigma g.
Vector3d RelaxedRod::moment_at(const TipLoad& load, const Vector3d& force, double sigma, const March& at) const {
  const Vector3d& g = load.distributed_tip_N_per_m;
  const Vector3d n = force + sigma * g;
  return load.moment_tip_Nm + contact_offset_m_.cross(force) - at.r.cross(n) + at.rho.cross(g);
}

void RelaxedRod::evaluate(const TipLoad& load, const Unknowns& z, Shape& shape) const {
  const Vector3d F = z.tail<3>();
  const double h = cell_m_, scale = length_m_ / std::sqrt(static_cast<double>(kCells));
  const Vector3d tip_moment = load.moment_tip_Nm + contact_offset_m_.cross(F), factor = compliance_factor(load);
  March at;
  for (int i = 0; i < kCells; ++i) {
    const Cell& cell = cells_[i];
    const Bending bending = cell.under(load, factor);
    Vector3d u = bending.free_curvature + bending.compliance.cwiseProduct(tip_moment);
    Columns d_u = Columns::Zero();
    for (int b = 0; b < kPowers; ++b) {
      u += cell.powers(b) * z.segment<3>(3 * b);
      d_u.block<3, 3>(0, 3 * b).diagonal().setConstant(cell.powers(b));
    }
    d_u.block<3, 3>(0, kForce) = bending.compliance.asDiagonal() * hat(contact_offset_m_);
    record_cell(i, at, u, d_u, shape.curve);

    March middle = at;
    middle.turn(u, d_u, 0.5 * h);
    middle.walk(middle, 0.5 * h);
    const double sigma = (i + 0.5) * h;
    const Vector3d local = middle.R.transpose() * moment_at(load, F, sigma, middle);
    Columns d_mu = hat(F + sigma * load.distributed_tip_N_per_m) * middle.d_r;
    d_mu.block<3, 3>(0, kForce) += hat(contact_offset_m_ - middle.r);
    const Columns d_local = hat(local) * middle.d_R + middle.R.transpose() * d_mu;
    shape.defect.segment<3>(3 * i) = scale * (u - bending.free_curvature - bending.compliance.cwiseProduct(local));
    shape.defect_by_unknown.block<3, kUnknowns>(3 * i, 0) = scale * (d_u - bending.compliance.asDiagonal() * d_local);

    at.walk(middle, h);
    at.turn(u, d_u, h);
  }
  to_base_frame(at, shape.curve);
}

/// The stations of one cell, still in the tip frame.
void RelaxedRod::record_cell(int cell, const March& from, const Vector3d& u, const Columns& d_u,
                             RodSolution<kUnknowns>& curve) const {
  for (std::size_t k = 0; k < stations_.size(); ++k) {
    const Station& place = stations_[k];
    if (place.cell != cell) continue;
    March middle = from, at = from;
    middle.turn(u, d_u, 0.5 * place.into_m);
    at.walk(middle, place.into_m);
    at.turn(u, d_u, place.into_m);
    curve.points[k].T_base_local = {at.R, at.r + at.R.col(2) * place.beyond_tip_m};
    curve.tangents[k].rotation = at.d_R;
    curve.tangents[k].position_m = at.d_r;  // beyond the tip R stays the identity
  }
}

/// T_base_local = T_tip_base^-1 T_tip_local.
void RelaxedRod::to_base_frame(const March& clamp, RodSolution<kUnknowns>& curve) {
  const Matrix3d R_base_tip = clamp.R.transpose();
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    Pose& T = curve.points[i].T_base_local;
    RodPointTangent<kUnknowns>& tangent = curve.tangents[i];
    T = {R_base_tip * T.R, R_base_tip * (T.p - clamp.r)};
    tangent.rotation -= T.R.transpose() * clamp.d_R;
    tangent.position_m = (R_base_tip * (tangent.position_m - clamp.d_r) + hat(T.p) * clamp.d_R).eval();
  }
  curve.T_base_tip = {R_base_tip, -(R_base_tip * clamp.r)};
}

/// Explicit midpoint rule: the curvature at a cell's distal end leads to its middle, the curvature there through it.
RelaxedRod::Unknowns RelaxedRod::start(const TipLoad& load, Shape& shape) const {
  const Vector3d& F = load.force_tip_N;
  const Vector3d tip_moment = load.moment_tip_Nm + contact_offset_m_.cross(F), factor = compliance_factor(load);
  const Columns no_tangent = Columns::Zero();
  const auto elastic_curvature = [&](const Bending& bending, double sigma, const March& at) -> Vector3d {
    return bending.compliance.cwiseProduct(at.R.transpose() * moment_at(load, F, sigma, at));
  };
  Eigen::Matrix<double, kCells, 3> beyond_tip_curvature;
  March at;
  for (int i = 0; i < kCells; ++i) {
    const Bending bending = cells_[i].under(load, factor);
    const double h = cell_m_;
    March middle = at;
    middle.turn(bending.free_curvature + elastic_curvature(bending, i * h, at), no_tangent, 0.5 * h);
    middle.walk(middle, 0.5 * h);
    const Vector3d elastic = elastic_curvature(bending, (i + 0.5) * h, middle);
    const Vector3d u = bending.free_curvature + elastic;
    beyond_tip_curvature.row(i) = elastic - bending.compliance.cwiseProduct(tip_moment);
    record_cell(i, at, u, no_tangent, shape.curve);
    at.walk(middle, h);
    at.turn(u, no_tangent, h);
  }
  to_base_frame(at, shape.curve);
  const Eigen::Matrix<double, kPowers, 3> coefficients = projection_ * beyond_tip_curvature;
  Unknowns z;
  for (int b = 0; b < kPowers; ++b) z.segment<3>(3 * b) = coefficients.row(b).transpose();
  z.tail<3>() = F;
  return z;
}

}  // namespace palpate
