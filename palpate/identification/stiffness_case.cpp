// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <palpate/identification/stiffness_case.hpp>

namespace palpate::stiffness {

namespace {

bool on_grid(const ShapePoint& point) { return std::isnan(point.arc_length_m); }
bool told(const ShapePoint& point, int axis) {
  return !std::isnan(point.position_base_m(axis)) && !(axis == 2 && on_grid(point));
}

/// Places between which Hermite's cubic is exact to a nanometre or so on a catheter: its error is h^4 r'''' / 384.
std::vector<double> grid_m(const Rod& rod) {
  constexpr int kCells = 32;
  const double reach = rod.length_m() + rod.rigid_tip_m;
  std::vector<double> grid;
  for (int i = 0; i <= kCells; ++i) grid.push_back(std::min(reach, reach * i / kCells));
  for (const Section& section : rod.sections) grid.push_back(section.to_m);
  std::sort(grid.begin(), grid.end());
  const auto same = [&](double a, double b) { return b - a < 1e-9 * reach; };
  grid.erase(std::unique(grid.begin(), grid.end(), same), grid.end());
  return grid;
}

/// Clamp axes to the stated base frame: p -> R p + shift, R exp of the clamp's turn.
void to_stated_base(const Numbers& q, Place& place) {
  const Matrix3d R = exp_so3(q.segment<3>(kTurn)), J = right_jacobian(q.segment<3>(kTurn));
  const Vector3d p = place.T_base_point.p, t = place.tangent;
  const Matrix3d R_clamp_point = place.T_base_point.R;
  place.T_base_point = {R * R_clamp_point, R * p + q.segment<3>(kShift)};
  place.tangent = R * t;
  place.by_p = R * place.by_p;
  place.by_tangent = R * place.by_tangent;
  place.by_p.middleCols<3>(kTurn) -= R * hat(p) * J;
  place.by_tangent.middleCols<3>(kTurn) -= R * hat(t) * J;
  place.by_rotation.middleCols<3>(kTurn) += R_clamp_point.transpose() * J;
  place.by_p.middleCols<3>(kShift).setIdentity();
}

/// Hermite's cubic between two places h apart, at share x, and its derivative along the shaft in `tangent`.
Place between(const Place& a, const Place& b, double h, double x) {
  const double y = 1.0 - x;
  const double A = y * y * (1.0 + 2.0 * x), B = x * x * (1.0 + 2.0 * y), a1 = h * x * y * y, b1 = -h * x * x * y;
  Place c = x < 0.5 ? a : b;
  c.T_base_point.p = A * a.T_base_point.p + B * b.T_base_point.p + a1 * a.tangent + b1 * b.tangent;
  c.by_p = A * a.by_p + B * b.by_p + a1 * a.by_tangent + b1 * b.by_tangent;
  const double slope = 6.0 * x * y / h;
  c.tangent =
      slope * (b.T_base_point.p - a.T_base_point.p) + y * (1.0 - 3.0 * x) * a.tangent + x * (1.0 - 3.0 * y) * b.tangent;
  return c;
}

/// Where the shaft first is as far along e3 as z; its nearest place where it never is. The place moves along the shaft
/// as the shaft bends: d(x, y)/dq at this z = by_p - tangent / tangent_z * by_p_z.
Place at_height(std::span<const Place> grid, std::span<const double> s, double z) {
  const auto height = [](const Place& place) { return place.T_base_point.p.z(); };
  for (std::size_t i = 0; i + 1 < grid.size(); ++i) {
    if (!(height(grid[i]) <= z && z <= height(grid[i + 1]))) continue;
    const double h = s[i + 1] - s[i];
    double low = 0.0, high = 1.0;
    for (int k = 0; k < 50; ++k) {
      const double middle = 0.5 * (low + high);
      (height(between(grid[i], grid[i + 1], h, middle)) < z ? low : high) = middle;
    }
    Place place = between(grid[i], grid[i + 1], h, 0.5 * (low + high));
    const Eigen::Matrix<double, 1, kNumbers> by_z = place.by_p.row(2);
    if (place.tangent.z() > 1e-3) place.by_p -= (place.tangent / place.tangent.z()) * by_z;
    return place;
  }
  return *std::min_element(grid.begin(), grid.end(), [&](const Place& a, const Place& b) {
    return std::abs(height(a) - z) < std::abs(height(b) - z);
  });
}

void add(double sign, const Place& own, Place& sum) {
  sum.T_base_point.p += sign * own.T_base_point.p;
  sum.tangent += sign * own.tangent;
  sum.by_p += sign * own.by_p;
  sum.by_tangent += sign * own.by_tangent;
}

}  // namespace

int rows_of(const ShapePoint& point) {
  return told(point, 0) + told(point, 1) + told(point, 2) + (point.R_base_sensor ? 3 : 0);
}

CaseModel::CaseModel(const Rod& rod, const LoadCase& load_case, StiffnessOptions::OwnWeight own_weight, Moving moving,
                     const Vector3d& force_direction)
    : case_(&load_case) {
  bool grid = false;
  for (const ShapePoint& point : load_case.points) {
    rows_ += rows_of(point);
    grid = grid || on_grid(point);
    station_of_point_.push_back(on_grid(point) ? -1 : static_cast<int>(stations_m_.size()));
    if (on_grid(point)) continue;
    stations_m_.push_back(point.arc_length_m);
    mounts_.push_back(point.T_local_sensor);
  }
  grid_from_ = static_cast<int>(stations_m_.size());
  if (grid)
    for (const double s : grid_m(rod)) stations_m_.push_back(s);
  mounts_.resize(stations_m_.size());

  const Vector3d weight = rod.distributed_load_base_N_per_m;
  const DeadLoad all{load_case.force_base_N, weight, {}}, own{Vector3d::Zero(), weight, {}};
  const auto add_shape = [&](double sign, const DeadLoad& load, const Vector3d& direction) {
    shapes_.push_back({sign, FollowedShape(rod, stations_m_, load, direction, moving)});
  };
  add_shape(1.0, all, force_direction);
  if (own_weight == StiffnessOptions::OwnWeight::kSubtracted && rod.has_distributed_load()) {
    add_shape(-1.0, own, Vector3d::Zero());
    add_shape(1.0, {}, Vector3d::Zero());
  }
}

CaseModel::Start CaseModel::start() const {
  Start start;
  for (const Signed& part : shapes_) start.push_back(part.shape.start());
  return start;
}

void CaseModel::set_start(const Start& start) {
  for (std::size_t i = 0; i < shapes_.size(); ++i) shapes_[i].shape.set_start(start[i]);
}

int CaseModel::evaluations() const {
  int sum = 0;
  for (const Signed& part : shapes_) sum += part.shape.evaluations();
  return sum;
}

void CaseModel::place_points(const Numbers& q) {
  places_ = shapes_.front().shape.places(mounts_);
  for (std::size_t part = 1; part < shapes_.size(); ++part) {
    const std::vector<Place> own = shapes_[part].shape.places(mounts_);
    for (std::size_t i = 0; i < own.size(); ++i) add(shapes_[part].sign, own[i], places_[i]);
  }
  for (Place& place : places_) to_stated_base(q, place);
  points_.clear();
  const auto from = static_cast<std::size_t>(grid_from_);
  for (std::size_t i = 0; i < case_->points.size(); ++i) {
    const int station = station_of_point_[i];
    points_.push_back(station >= 0 ? places_[station]
                                   : at_height(std::span(places_).subspan(from), std::span(stations_m_).subspan(from),
                                               case_->points[i].position_base_m.z()));
  }
}

bool CaseModel::evaluate(const Numbers& q, double unknown_sigma_m, Eigen::Ref<Eigen::VectorXd> residual,
                         Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, kNumbers>> by_q, double closed_rad) {
  for (Signed& part : shapes_)
    if (!part.shape.solve(q, closed_rad)) return false;
  place_points(q);
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const ShapePoint& measured = case_->points[i];
    const Place& place = points_[i];
    for (int axis = 0; axis < 3; ++axis) {
      if (!told(measured, axis)) continue;
      const double sigma = measured.sigma_m.isZero(0.0) ? unknown_sigma_m : measured.sigma_m(axis);
      residual(row) = (measured.position_base_m(axis) - place.T_base_point.p(axis)) / sigma;
      by_q.row(row++) = -place.by_p.row(axis) / sigma;
    }
    if (!measured.R_base_sensor) continue;
    const Vector3d e = log_so3(place.T_base_point.R.transpose() * *measured.R_base_sensor);
    residual.segment<3>(row) = e / measured.sigma_rad;
    by_q.middleRows<3>(row) = -inverse_left_jacobian(e) * place.by_rotation / measured.sigma_rad;
    row += 3;
  }
  return residual.allFinite() && by_q.allFinite();
}

}  // namespace palpate::stiffness
