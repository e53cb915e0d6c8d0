// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <palpate/identification/followed_shape.hpp>

namespace palpate::stiffness {

namespace {

constexpr double kTrustedTurn_rad = 0.4;  // of the tip between two solutions: the prediction is surely on the branch
constexpr double kLeastShare = 1e-3;      // of the way to new numbers, in one step
constexpr int kMostIntegrations = 150;    // on it
constexpr double kRestLog = 20.0;         // of a shaft so stiff that no load moves it: where every branch begins

std::vector<int> moving_numbers(const Moving& moving) {
  std::vector<int> numbers{kLogStiffness, kLogStiffness + 1, kLogStiffness + 2};
  const auto add = [&](bool present, int first, int count) {
    for (int i = 0; present && i < count; ++i) numbers.push_back(first + i);
  };
  add(moving.shear, kLogShear, 1);
  add(moving.turn, kTurn, 3);
  add(moving.precurvature, kPrecurvature, 3);
  add(moving.force, kExtraForce, 1);
  return numbers;
}

}  // namespace

FollowedShape::FollowedShape(const Rod& rod, std::vector<double> arc_lengths_m, const DeadLoad& load,
                             const Vector3d& force_direction, Moving moving)
    : solver_(rod, arc_lengths_m, Accuracy::kRealtime),
      load_(load),
      force_direction_(force_direction),
      number_of_column_(moving_numbers(moving)),
      places_(arc_lengths_m.size()) {
  RodSolution<0> unloaded = solver_.make_solution<0>();
  solver_.solve({}, unloaded);
  last_.R_tip_base = unloaded.T_base_tip.R.transpose();
  last_.q.segment<3>(kLogStiffness).setConstant(kRestLog);
  if (rod.shears()) last_.q(kLogShear) = kRestLog;
}

/// Loads as the turned clamp sees them, R^T F, and all of it over the change of the shear stiffness.
DeadLoad FollowedShape::load_at(const Numbers& q) const {
  const Matrix3d R = exp_so3(q.segment<3>(kTurn));
  const double per_shear = std::exp(-q(kLogShear));
  DeadLoad load;
  load.force_base_N = per_shear * (R.transpose() * (load_.force_base_N + q(kExtraForce) * force_direction_));
  load.distributed_base_N_per_m = per_shear * (R.transpose() * load_.distributed_base_N_per_m);
  load.tip.log_stiffness = q.segment<3>(kLogStiffness).array() - q(kLogShear);
  load.tip.precurvature_per_m = q.segment<3>(kPrecurvature);
  return load;
}

template <int N>
DeadLoadDirections<N> FollowedShape::directions_at(const Numbers& q, const DeadLoad& load) const {
  const Vector3d turn = q.segment<3>(kTurn);
  const Matrix3d J = right_jacobian(turn);
  DeadLoadDirections<N> d;
  for (std::size_t i = 0; i < number_of_column_.size(); ++i) {
    const int number = number_of_column_[i];
    const auto column = static_cast<Eigen::Index>(i);
    if (number < kLogShear) {
      d.log_stiffness(number - kLogStiffness, column) = 1.0;
    } else if (number == kLogShear) {
      d.log_stiffness.col(column).setConstant(-1.0);
      d.force_base_N.col(column) = -load.force_base_N;
      d.distributed_tip_N_per_m.col(column) = -load.distributed_base_N_per_m;
    } else if (number < kShift) {
      d.force_base_N.col(column) = hat(load.force_base_N) * J.col(number - kTurn);
      d.distributed_tip_N_per_m.col(column) = hat(load.distributed_base_N_per_m) * J.col(number - kTurn);
    } else if (number < kExtraForce) {
      d.precurvature_per_m(number - kPrecurvature, column) = 1.0;
    } else {
      d.force_base_N.col(column) = std::exp(-q(kLogShear)) * (exp_so3(turn).transpose() * force_direction_);
    }
  }
  return d;
}

template <int N>
bool FollowedShape::solve_near(const Numbers& q, double closed_rad) {
  const Vector3d turn = last_.turn * (q - last_.q);
  if (!(turn.norm() < kTrustedTurn_rad)) return false;
  const DeadLoad load = load_at(q);
  DeadLoadSolution<N> solution = make_dead_load_solution<N>(solver_);
  const Matrix3d predicted = last_.R_tip_base * exp_so3(turn);
  const WeightedSolve solve =
      solve_dead_load<N>(solver_, load, directions_at<N>(q, load), predicted, solution, closed_rad);
  evaluations_ += solve.evaluations;
  if (!solve.converged || !solution.shape.tip_rotation.allFinite()) return false;
  if (!(log_so3(predicted.transpose() * solution.R_tip_base).norm() < kTrustedTurn_rad)) return false;
  keep<N>(q, solution);
  return true;
}

template <int N>
void FollowedShape::keep(const Numbers& q, const DeadLoadSolution<N>& solution) {
  last_.q = q;
  last_.R_tip_base = solution.R_tip_base;
  last_.least_determinant = std::min(last_.least_determinant, solution.determinant);
  for (std::size_t c = 0; c < number_of_column_.size(); ++c)
    last_.turn.col(number_of_column_[c]) = solution.turn.col(static_cast<Eigen::Index>(c));
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const RodPoint& point = solution.shape.points[i];
    const RodPointTangent<N>& by = solution.shape.tangents[i];
    Place& place = places_[i];
    const Vector3d v = Vector3d::UnitZ() + point.shear_strain;
    place.T_base_point = point.T_base_local;
    place.tangent = point.T_base_local.R * v;
    for (std::size_t c = 0; c < number_of_column_.size(); ++c) {
      const auto column = static_cast<Eigen::Index>(c);
      const int number = number_of_column_[c];
      place.by_p.col(number) = by.position_m.col(column);
      place.by_rotation.col(number) = by.rotation.col(column);
      place.by_tangent.col(number) =
          point.T_base_local.R * (by.rotation.col(column).cross(v) + by.shear_strain.col(column));
    }
  }
}

bool FollowedShape::solve_in_one(const Numbers& q, double closed_rad) {
  const std::size_t columns = number_of_column_.size();
  if (columns <= 3) return solve_near<3>(q, closed_rad);
  if (columns <= 6) return solve_near<6>(q, closed_rad);
  if (columns <= 9) return solve_near<9>(q, closed_rad);
  return solve_near<12>(q, closed_rad);
}

bool FollowedShape::solve(const Numbers& q, double closed_rad) {
  if (!q.allFinite()) return false;
  const int most = evaluations_ + kMostIntegrations;
  for (double share = 1.0; share > kLeastShare && evaluations_ < most;) {
    const bool whole = share >= 1.0;
    const Numbers next = whole ? q : Numbers(last_.q + share * (q - last_.q));
    if (!solve_in_one(next, closed_rad))
      share *= 0.5;
    else if (whole)
      return true;
    else
      share = std::min(1.0, 2.0 * share / (1.0 - share));
  }
  return false;
}

void FollowedShape::restart(const Numbers& q, const Matrix3d& R_tip_base) {
  last_ = {};
  last_.q = q;
  last_.R_tip_base = R_tip_base;
}

std::vector<Place> FollowedShape::places(std::span<const Pose> mounts) const {
  std::vector<Place> seen = places_;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Matrix3d R = seen[i].T_base_point.R;
    seen[i].T_base_point = seen[i].T_base_point * mounts[i];
    seen[i].by_p -= R * hat(mounts[i].p) * seen[i].by_rotation;
    seen[i].by_rotation = mounts[i].R.transpose() * seen[i].by_rotation;
  }
  return seen;
}

}  // namespace palpate::stiffness
