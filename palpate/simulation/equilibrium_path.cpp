// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <palpate/math/errors.hpp>
#include <palpate/simulation/equilibrium_path.hpp>

namespace palpate {

namespace {

constexpr double kSameBranch_rad = 0.05;
constexpr double kLeastStep = 1e-6;

double angle_between(const Matrix3d& a, const Matrix3d& b) { return log_so3(a.transpose() * b).norm(); }

/// Newton's step for an excess, by a derivative. Along a direction in which g hardly changes there is none: a neutral
/// one, or a bifurcation.
Vector3d newton_step(const Matrix3d& excess_by_force, const Vector3d& excess_N) {
  Eigen::JacobiSVD<Matrix3d> svd(excess_by_force, Eigen::ComputeFullU | Eigen::ComputeFullV);
  svd.setThreshold(1e-9);
  return -svd.solve(excess_N);
}

Vector3d newton_step(const Balance& at) { return newton_step(at.excess_by_force, at.excess_N); }

/// Snaps close behind each other are one to whoever watches: its first place, all of its motion.
void join(const Snap& next, std::vector<Snap>& snaps) {
  constexpr double kOneSnap = 0.1;
  if (snaps.empty() || next.share - snaps.back().share > kOneSnap) {
    snaps.push_back(next);
    return;
  }
  Snap& all = snaps.back();
  all.settled = next.settled;
  all.tip_moved_m += next.tip_moved_m;
  all.tip_turned_rad += next.tip_turned_rad;
}

}  // namespace

void EquilibriumPath::rest(Situation situation) {
  situation.load_share = 0.0;
  situation_ = situation;
  anchor_.reset();
  rate_N_.setZero();
  if (!shaft_.balance(situation_, anchor_, Vector3d::Zero(), at_))
    throw InputError("catheter.weight_N_per_m: no equilibrium of the unloaded catheter under its own weight was found");
}

/// Where Newton's method starts: at the present force, from where its first step follows the branch's tangent, or at
/// the one that continues the last step; whichever is nearer. Flow makes the second a bad guess, a stiff wall the
/// first. Where the present force is the answer nothing else is tried: the shape is that of the last balance.
bool EquilibriumPath::start(const Situation& situation, double step, Balance& out) {
  if (!shaft_.balance(situation, anchor_, at_.force_tip_N, out)) return false;
  if (rate_N_.isZero(0.0) || newton_step(out).norm() <= closed_N()) return true;
  Balance continued;
  if (!shaft_.balance(situation, anchor_, Vector3d(at_.force_tip_N + step * rate_N_), continued)) return true;
  if (newton_step(continued).norm() < newton_step(out).norm()) out = continued;
  return true;
}

double EquilibriumPath::closed_N() const { return 1e-11 * shaft_.force_scale_N() + 1e-14 * at_.force_tip_N.norm(); }

/// Newton's method over another `step` of the way. A step of it is halved where the next one by the same derivative
/// would be longer (Deuflhard's natural monotonicity: a stiff wall's excess itself says little). False: see
/// EquilibriumPath.
bool EquilibriumPath::correct(const Situation& situation, double step, Balance& out) {
  constexpr int kMostSteps = 14, kMostHalvings = 3;
  const double scale = shaft_.force_scale_N();
  if (!start(situation, step, out)) return false;
  Matrix3d R_extrapolated = out.T_room_tip.R;
  for (int i = 0; i < kMostSteps; ++i) {
    Vector3d change = newton_step(out);
    if (!(change.norm() < 10.0 * scale)) return false;
    if (change.norm() <= closed_N())
      return out.stable && angle_between(R_extrapolated, out.T_room_tip.R) < kSameBranch_rad &&
             (out.force_tip_N - at_.force_tip_N).norm() <= scale;
    const Vector3d from_N = out.force_tip_N;
    const Matrix3d excess_by_force = out.excess_by_force;
    const double length_N = change.norm();
    const bool touched = out.contact.touches;
    for (int halvings = 0; halvings <= kMostHalvings; ++halvings, change *= 0.5) {
      if (!shaft_.balance(situation, anchor_, from_N + change, out)) return false;
      if (newton_step(excess_by_force, out.excess_N).norm() <= length_N || out.contact.touches != touched) break;
    }
    if (i == 0) R_extrapolated = out.T_room_tip.R;
  }
  return false;
}

void EquilibriumPath::accept(const Situation& situation, const Balance& balance) {
  at_ = balance;
  situation_ = situation;
  anchor_ = next_anchor(shaft_.load(), situation, anchor_, at_.place_room_m);
}

std::vector<Snap> EquilibriumPath::follow(const Situation& to) {
  constexpr int kMostSnaps = 20, kMostCorrections = 10000;
  std::vector<Snap> snaps;
  const Situation from = situation_;
  if (shaft_.load_in_tip()) {
    Balance next;
    const bool found = shaft_.balance(to, anchor_, to.load_share * (to.force_N + to.flow_tip_N), next);
    if (!found) snaps.push_back({.share = 1.0, .force_N = to.force_N.norm(), .settled = false});
    accept(to, next);
    return snaps;
  }
  double share = 0.0, step = 1.0;
  int tries = 0;
  for (int corrections = 0; share < 1.0; ++corrections) {
    const double target = std::min(1.0, share + step);
    const Situation situation = target == 1.0 ? to : between(from, to, target);
    Balance next;
    if (correct(situation, target - share, next)) {
      rate_N_ = (next.force_tip_N - at_.force_tip_N) / (target - share);
      accept(situation, next);
      share = target;
      step *= 2.0;
    } else if (step *= 0.5; step < kLeastStep || corrections > kMostCorrections) {
      join(snap(from, to, share), snaps);
      if (++tries == kMostSnaps) snaps.back().settled = false;
      if (!snaps.back().settled) return snaps;
      step = 1e-2;
    }
  }
  return snaps;
}

/// Leaves the branch at `share`, a little further on, so that what was lost is surely gone.
Snap EquilibriumPath::snap(const Situation& from, const Situation& to, double& share) {
  constexpr double kBeyond = 0.02;
  Snap snap{.share = share, .force_N = at_.contact.force_room_N.norm()};
  const Balance before = at_;
  share = std::min(1.0, share + kBeyond);
  const Situation situation = share == 1.0 ? to : between(from, to, share);
  const Eigen::JacobiSVD<Matrix3d> svd(before.excess_by_force, Eigen::ComputeFullV);
  const Vector3d softest = svd.matrixV().col(2), push = 1e-3 * shaft_.force_scale_N() * softest;
  snap.settled = false;
  for (const double sense : {1.0, -1.0, 30.0, -30.0}) {
    Balance after;
    if (!settle(situation, sense * push, after)) continue;
    accept(situation, after);
    snap.settled = true;
    break;
  }
  snap.tip_moved_m = (at_.place_room_m - before.place_room_m).norm();
  snap.tip_turned_rad = angle_between(before.T_room_tip.R, at_.T_room_tip.R);
  rate_N_.setZero();
  return snap;
}

/// From the present state, pushed a little, to a stable equilibrium.
bool EquilibriumPath::settle(const Situation& situation, const Vector3d& push_N, Balance& out) {
  constexpr int kMostNewton = 20;
  const Anchor held = anchor_;
  Balance state;
  bool found = shaft_.balance(situation, anchor_, at_.force_tip_N + push_N, state) && relax(situation, anchor_, state);
  for (int i = 0; found && i < kMostNewton; ++i) {
    const Vector3d step = newton_step(state);
    if (step.norm() <= 1e-11 * shaft_.force_scale_N() + 1e-14 * state.force_tip_N.norm()) {
      out = state;
      if (state.stable) return true;
      break;
    }
    found = shaft_.balance(situation, anchor_, Vector3d(state.force_tip_N + step), state);
  }
  anchor_ = held;
  return false;
}

/// With r = F_room - R F the force that drives the tip, P dF = dt (r + dr/dF dF), made square and kept from blowing up
/// where P does not move the tip: (P^T P + e^2 I - dt P^T dr/dF) dF = dt P^T r. A step is shortened until the matrix is
/// positive definite (with friction: its eigenvalues' real parts), for then it loses energy.
bool EquilibriumPath::relax(const Situation& situation, Anchor& anchor, Balance& state) {
  constexpr int kMostSteps = 1000;
  constexpr double kTurn_rad = 0.05;
  const double scale = shaft_.force_scale_N(), compliance_m_per_N = shaft_.compliance_m_per_N();
  const double e2 = std::pow(0.03 * compliance_m_per_N, 2);
  double dt = 1e-2 * compliance_m_per_N;
  for (int i = 0; i < kMostSteps; ++i) {
    const Matrix3d& R = state.T_room_tip.R;
    const Matrix3d& P = state.place_by_force_m_per_N;
    const Vector3d drive = -P.transpose() * R * state.excess_N;
    if (drive.norm() < 1e-7 * scale * compliance_m_per_N && dt > 100.0 * compliance_m_per_N) return true;
    const Matrix3d drive_by_force =
        -P.transpose() * R * (state.excess_by_force - hat(state.excess_N) * state.turn_by_force_per_N);
    const Matrix3d mass = P.transpose() * P + e2 * Matrix3d::Identity();
    Vector3d step;
    for (int halvings = 0; halvings < 60; ++halvings, dt *= 0.5) {
      const Matrix3d A = mass - dt * drive_by_force;
      step = A.partialPivLu().solve(dt * drive);
      const double least = Eigen::EigenSolver<Matrix3d>(A, false).eigenvalues().real().minCoeff();
      if (least > 0.5 * e2 && (state.turn_by_force_per_N * step).norm() < kTurn_rad && step.norm() < 0.5 * scale) break;
    }
    if (!shaft_.balance(situation, anchor, Vector3d(state.force_tip_N + step), state)) return false;
    anchor = next_anchor(shaft_.load(), situation, anchor, state.place_room_m);
    dt *= 1.5;
  }
  return false;
}

}  // namespace palpate
