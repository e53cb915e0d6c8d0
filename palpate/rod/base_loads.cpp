// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <palpate/rod/base_loads.hpp>

namespace palpate {

namespace {

constexpr double kClosed_rad = 1e-12;     // residual of the loop, near the rounding of a rotation
constexpr double kSameBranch_rad = 0.05;  // from the extrapolated tip rotation: a step is small enough to be followed

/// Residual e = log(Q^T R_tip_base) and A = de/d delta for Q -> Q exp(delta), given how the tip rotation answers:
/// `phi_per_delta` = d(body rotation of R_base_tip)/d delta.
struct Loop {
  Vector3d e;
  Matrix3d A;
};

Loop close_loop(const Matrix3d& Q, const Matrix3d& R_base_tip, const Matrix3d& phi_per_delta) {
  Loop loop;
  loop.e = log_so3(Q.transpose() * R_base_tip.transpose());
  loop.A = -inverse_left_jacobian(loop.e) - inverse_right_jacobian(loop.e) * R_base_tip * phi_per_delta;
  return loop;
}

}  // namespace

template <int N>
WeightWorkspace<N> make_weight_workspace(const RodSolver& solver) {
  return {solver.make_solution<0>(), solver.make_solution<N + 3>()};
}

namespace {

/// Adds what the turning weight contributes: total = partial + S_g dg/dp, with A delta = R_base_tip phi_p.
template <int N>
void total_derivatives(const RodSolution<N + 3>& partial, const Matrix3d& dg_per_delta, const Matrix3d& A,
                       RodSolution<N>& total) {
  const Matrix3d& R_base_tip = partial.T_base_tip.R;
  const auto along = [](const auto& m) { return m.template leftCols<N>(); };
  const auto by_weight = [](const auto& m) { return m.template rightCols<3>(); };
  const Eigen::Matrix<double, 3, N> dg =
      dg_per_delta * A.partialPivLu().solve(R_base_tip * along(partial.tip_rotation));
  const auto combine = [&](const auto& m) -> Eigen::Matrix<double, 3, N> { return along(m) + by_weight(m) * dg; };
  for (std::size_t i = 0; i < partial.points.size(); ++i) {
    const RodPointTangent<N + 3>& from = partial.tangents[i];
    RodPointTangent<N>& to = total.tangents[i];
    to.rotation = combine(from.rotation);
    to.position_m = combine(from.position_m);
    to.curvature_per_m = combine(from.curvature_per_m);
    to.shear_strain = combine(from.shear_strain);
    to.force_local_N = combine(from.force_local_N);
    to.moment_local_Nm = combine(from.moment_local_Nm);
    total.points[i] = partial.points[i];
  }
  total.tip_rotation = combine(partial.tip_rotation);
  total.T_base_tip = partial.T_base_tip;
}

template <int N>
LoadDirections<N + 3> with_weight_columns(const LoadDirections<N>& d) {
  LoadDirections<N + 3> w;
  w.force_tip_N.template leftCols<N>() = d.force_tip_N;
  w.moment_tip_Nm.template leftCols<N>() = d.moment_tip_Nm;
  w.tendon_couple_Nm.template leftCols<N>() = d.tendon_couple_Nm;
  w.log_stiffness.template leftCols<N>() = d.log_stiffness;
  w.precurvature_per_m.template leftCols<N>() = d.precurvature_per_m;
  w.distributed_tip_N_per_m.template rightCols<3>().setIdentity();
  return w;
}

}  // namespace

template <int N>
WeightedSolve solve_under_weight(const RodSolver& solver, const TipLoad& load, const LoadDirections<N>& directions,
                                 WeightWorkspace<N>& workspace, RodSolution<N>& solution) {
  if (!solver.rod().has_distributed_load() && directions.distributed_tip_N_per_m.isZero(0.0)) {
    solver.solve(load, directions, solution);
    return {.converged = true, .evaluations = 1};
  }
  const Vector3d& w_base = solver.rod().distributed_load_base_N_per_m;
  LoadDirections<N + 3> with_weight = with_weight_columns(directions);
  TipLoad total = load;
  total.distributed_tip_N_per_m.setZero();
  solver.solve(total, workspace.value);
  Matrix3d Q = workspace.value.T_base_tip.R.transpose();

  constexpr int kMaxIterations = 24;
  for (int iteration = 1; iteration <= kMaxIterations; ++iteration) {
    total.distributed_tip_N_per_m = Q * w_base;
    with_weight.distributed_tip_N_per_m.template leftCols<N>() = Q * directions.distributed_tip_N_per_m;
    solver.solve(total, with_weight, workspace.tangent);
    const Matrix3d dg_per_delta = -Q * hat(w_base);
    const Loop loop = close_loop(Q, workspace.tangent.T_base_tip.R,
                                 workspace.tangent.tip_rotation.template rightCols<3>() * dg_per_delta);
    const bool closed = loop.e.norm() < 1e-10;
    if (closed || iteration == kMaxIterations) {
      total_derivatives<N>(workspace.tangent, dg_per_delta, loop.A, solution);
      return {.converged = closed, .evaluations = iteration + 1};
    }
    Vector3d delta = -loop.A.partialPivLu().solve(loop.e);
    if (delta.norm() > 0.5) delta *= 0.5 / delta.norm();  // the loop is smooth on this scale: no overshoot
    Q = Q * exp_so3(delta);
  }
  return {.converged = false, .evaluations = kMaxIterations + 1};
}

template WeightWorkspace<3> make_weight_workspace<3>(const RodSolver&);
template WeightWorkspace<6> make_weight_workspace<6>(const RodSolver&);
template WeightWorkspace<9> make_weight_workspace<9>(const RodSolver&);
template WeightWorkspace<12> make_weight_workspace<12>(const RodSolver&);
template WeightedSolve solve_under_weight<3>(const RodSolver&, const TipLoad&, const LoadDirections<3>&,
                                             WeightWorkspace<3>&, RodSolution<3>&);
template WeightedSolve solve_under_weight<6>(const RodSolver&, const TipLoad&, const LoadDirections<6>&,
                                             WeightWorkspace<6>&, RodSolution<6>&);
template WeightedSolve solve_under_weight<9>(const RodSolver&, const TipLoad&, const LoadDirections<9>&,
                                             WeightWorkspace<9>&, RodSolution<9>&);
template WeightedSolve solve_under_weight<12>(const RodSolver&, const TipLoad&, const LoadDirections<12>&,
                                              WeightWorkspace<12>&, RodSolution<12>&);

// ---------------------------------------------------------------------------------------------------------------

namespace {

/// One branch of equilibria, parametrised by the share of the load.
class Branch {
 public:
  Branch(const RodSolver& solver, const BaseLoad& load)
      : solver_(solver), load_(load), solution_(solver.make_solution<9>()) {
    directions_.force_tip_N.leftCols<3>().setIdentity();
    directions_.distributed_tip_N_per_m.middleCols<3>(3).setIdentity();
    directions_.moment_tip_Nm.rightCols<3>().setIdentity();
  }

  struct Point {
    double factor = 0.0;
    Matrix3d Q = Matrix3d::Identity();
    double least_stiffness = 0.0, determinant = 1.0;
  };

  /// Newton from `guess`; false where it does not close or ends too far from it to be surely the same branch.
  bool correct(double factor, const Matrix3d& guess, Point& point) {
    Matrix3d Q = guess;
    for (int iteration = 0; iteration < 12; ++iteration) {
      const Loop loop = evaluate(factor, Q);
      if (loop.e.norm() < kClosed_rad) {
        point = {factor, Q, least_stiffness(loop.A), (-loop.A).determinant()};
        return log_so3(guess.transpose() * Q).norm() < kSameBranch_rad;
      }
      const Vector3d delta = -loop.A.fullPivLu().solve(loop.e);
      if (!(delta.norm() < 0.5)) return false;
      Q = Q * exp_so3(delta);
    }
    return false;
  }

  TipLoad tip_load(double factor, const Matrix3d& Q) const {
    TipLoad tip = load_.tip;
    tip.force_tip_N = factor * (load_.tip.force_tip_N + Q * load_.force_base_N);
    tip.distributed_tip_N_per_m = factor * (Q * solver_.rod().distributed_load_base_N_per_m);
    return tip;
  }

  const Pose& T_base_tip() const { return solution_.T_base_tip; }
  int evaluations() const { return evaluations_; }

 private:
  Loop evaluate(double factor, const Matrix3d& Q) {
    solver_.solve(tip_load(factor, Q), directions_, solution_);
    ++evaluations_;
    const Matrix3d dF = -factor * Q * hat(load_.force_base_N);
    const Matrix3d dg = -factor * Q * hat(solver_.rod().distributed_load_base_N_per_m);
    const auto& phi = solution_.tip_rotation;
    return close_loop(Q, solution_.T_base_tip.R, phi.leftCols<3>() * dF + phi.middleCols<3>(3) * dg);
  }

  /// H = -Phi_M^-1 R_tip_base A R_base_tip: tip moment per tip rotation, symmetric under conservative loads.
  double least_stiffness(const Matrix3d& A) const {
    const Matrix3d R = solution_.T_base_tip.R;
    const Matrix3d Phi_M = solution_.tip_rotation.rightCols<3>();
    const Matrix3d H = -Phi_M.partialPivLu().solve(R.transpose() * A * R);
    return Eigen::SelfAdjointEigenSolver<Matrix3d>(0.5 * (H + H.transpose()), Eigen::EigenvaluesOnly).eigenvalues()(0);
  }

  const RodSolver& solver_;
  const BaseLoad& load_;
  LoadDirections<9> directions_;
  RodSolution<9> solution_;
  int evaluations_ = 0;
};

/// Load factor between two points where the least stiffness passes zero. Nothing where it does not: then they lie on
/// two branches. A real crossing is a place, up to the cube root of rounding; a bifurcation that an imperfection has
/// torn apart leaves a gap.
std::optional<double> locate_loss_of_stability(Branch& branch, Branch::Point stable, Branch::Point unstable) {
  constexpr double kOnePlace_rad = 1e-3;
  for (int i = 0; i < 40 && unstable.factor - stable.factor > 1e-9; ++i) {
    const double share =
        std::clamp(stable.least_stiffness / (stable.least_stiffness - unstable.least_stiffness), 0.1, 0.9);
    const double factor = stable.factor + share * (unstable.factor - stable.factor);
    Branch::Point point;
    if (!branch.correct(factor, stable.Q, point)) return std::nullopt;
    (point.least_stiffness > 0.0 ? stable : unstable) = point;
  }
  if (log_so3(stable.Q.transpose() * unstable.Q).norm() > kOnePlace_rad) return std::nullopt;
  return 0.5 * (stable.factor + unstable.factor);
}

/// A sixteenth of the load, and no more than 4 / pi^2 of a straight rod's Euler load: no critical load lies so close to
/// another that a step could pass both unseen.
double largest_step(const Rod& rod, const BaseLoad& load) {
  const Vector3d factor = compliance_factor(load.tip);
  double EI = std::numeric_limits<double>::infinity();
  for (const Section& section : rod.sections)
    if (!section.rigid) EI = std::min(EI, section.stiffness_Nm2.cwiseQuotient(factor).minCoeff());
  const double L = rod.length_m();
  const double force_N =
      load.force_base_N.norm() + load.tip.force_tip_N.norm() + L * rod.distributed_load_base_N_per_m.norm();
  return std::min(1.0 / 16, EI / (L * L * force_N));
}

}  // namespace

Equilibrium follow_from_rest(const RodSolver& solver, const BaseLoad& load) {
  constexpr int kMostEvaluations = 20000;
  const double largest = largest_step(solver.rod(), load), least = 1e-4 * largest;
  Branch branch(solver, load);
  Branch::Point point;
  auto at_rest = solver.make_solution<0>();
  TipLoad unloaded = load.tip;
  unloaded.force_tip_N.setZero();
  unloaded.distributed_tip_N_per_m.setZero();
  solver.solve(unloaded, at_rest);
  branch.correct(0.0, at_rest.T_base_tip.R.transpose(), point);
  const double stiffness_at_rest = point.least_stiffness;

  Equilibrium out;
  Matrix3d turn = Matrix3d::Identity();  // of the tip over the last step, per unit of load factor
  double step = largest, last_step = 0.0;
  while (point.factor < 1.0 && step > least && branch.evaluations() < kMostEvaluations) {
    const double factor = std::min(1.0, point.factor + step);
    const Vector3d secant =
        last_step > 0.0 ? Vector3d(log_so3(turn) * ((factor - point.factor) / last_step)) : Vector3d::Zero();
    Branch::Point next;
    bool followed = branch.correct(factor, point.Q * exp_so3(secant), next);
    if (followed && out.critical_load_factor == 0.0 && next.least_stiffness <= 0.0) {
      const std::optional<double> critical = locate_loss_of_stability(branch, point, next);
      followed = critical.has_value();
      out.critical_load_factor = critical.value_or(0.0);
    }
    if (!followed) {
      step *= 0.5;
      continue;
    }
    turn = point.Q.transpose() * next.Q;
    last_step = next.factor - point.factor;
    point = next;
    step = std::min(2.0 * step, largest);
  }

  branch.correct(point.factor, point.Q, point);
  out.load_factor = point.factor;
  out.load = branch.tip_load(point.factor, point.Q);
  out.T_base_tip = branch.T_base_tip();
  out.least_tip_stiffness_Nm = point.least_stiffness;
  out.determinant = point.determinant;
  out.evaluations = branch.evaluations();
  const bool ended = point.factor < 1.0, near = std::abs(point.least_stiffness) < 1e-4 * stiffness_at_rest;
  if (ended && out.critical_load_factor == 0.0) out.critical_load_factor = point.factor;
  if (ended || near)
    out.status = EquilibriumStatus::kAtBifurcation;
  else if (out.critical_load_factor > 0.0)
    out.status = EquilibriumStatus::kUnstable;
  return out;
}

}  // namespace palpate
