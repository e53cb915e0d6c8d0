// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <palpate/rod/dead_load.hpp>

namespace palpate {

namespace {

/// The given columns, then three for Q -> Q exp(delta): F_tip and g turn with it.
template <int N>
LoadDirections<N + 3> with_turn_columns(const DeadLoad& load, const DeadLoadDirections<N>& d, const Matrix3d& Q) {
  LoadDirections<N + 3> w;
  w.force_tip_N << d.force_tip_N + Q * d.force_base_N, -Q * hat(load.force_base_N);
  w.moment_tip_Nm.template leftCols<N>() = d.moment_tip_Nm;
  w.tendon_couple_Nm.template leftCols<N>() = d.tendon_couple_Nm;
  w.log_stiffness.template leftCols<N>() = d.log_stiffness;
  w.precurvature_per_m.template leftCols<N>() = d.precurvature_per_m;
  w.distributed_tip_N_per_m << Q * d.distributed_tip_N_per_m, -Q * hat(load.distributed_base_N_per_m);
  return w;
}

/// What is left of the loop's residual is moved away along the tangent: Q -> Q exp(delta).
template <int N>
RodPoint moved(RodPoint point, const RodPointTangent<N + 3>& by, const Vector3d& delta) {
  const auto along = [&](const auto& m) -> Vector3d { return m.template rightCols<3>() * delta; };
  point.T_base_local.R = point.T_base_local.R * exp_so3(along(by.rotation));
  point.T_base_local.p += along(by.position_m);
  point.curvature_per_m += along(by.curvature_per_m);
  point.shear_strain += along(by.shear_strain);
  point.force_local_N += along(by.force_local_N);
  point.moment_local_Nm += along(by.moment_local_Nm);
  return point;
}

/// total = partial + S_Q turn.
template <int N>
void finish(const Vector3d& delta, DeadLoadSolution<N>& solution) {
  const RodSolution<N + 3>& partial = solution.partial;
  const auto total = [&](const auto& m) -> Eigen::Matrix<double, 3, N> {
    return m.template leftCols<N>() + m.template rightCols<3>() * solution.turn;
  };
  RodSolution<N>& shape = solution.shape;
  for (std::size_t i = 0; i < partial.points.size(); ++i) {
    const RodPointTangent<N + 3>& from = partial.tangents[i];
    RodPointTangent<N>& to = shape.tangents[i];
    to.rotation = total(from.rotation);
    to.position_m = total(from.position_m);
    to.curvature_per_m = total(from.curvature_per_m);
    to.shear_strain = total(from.shear_strain);
    to.force_local_N = total(from.force_local_N);
    to.moment_local_Nm = total(from.moment_local_Nm);
    shape.points[i] = moved<N>(partial.points[i], from, delta);
  }
  shape.tip_rotation = total(partial.tip_rotation);
  solution.R_tip_base = solution.R_tip_base * exp_so3(delta);
  shape.T_base_tip = {solution.R_tip_base.transpose(), partial.T_base_tip.p};
}

}  // namespace

template <int N>
DeadLoadSolution<N> make_dead_load_solution(const RodSolver& solver) {
  return {.shape = solver.make_solution<N>(),
          .R_tip_base = Matrix3d::Identity(),
          .turn = Eigen::Matrix<double, 3, N>::Zero(),
          .partial = solver.make_solution<N + 3>()};
}

template <int N>
WeightedSolve solve_dead_load(const RodSolver& solver, const DeadLoad& load, const DeadLoadDirections<N>& directions,
                              const Matrix3d& R_tip_base, DeadLoadSolution<N>& solution, double tangent_suffices_rad) {
  constexpr int kMostIntegrations = 12;
  Matrix3d& Q = solution.R_tip_base;
  Q = R_tip_base;
  TipLoad tip = load.tip;
  for (int i = 1; i <= kMostIntegrations; ++i) {
    tip.force_tip_N = load.tip.force_tip_N + Q * load.force_base_N;
    tip.distributed_tip_N_per_m = Q * load.distributed_base_N_per_m;
    solver.solve(tip, with_turn_columns(load, directions, Q), solution.partial);
    const Matrix3d& R_base_tip = solution.partial.T_base_tip.R;
    const auto& phi = solution.partial.tip_rotation;
    const Vector3d e = log_so3(Q.transpose() * R_base_tip.transpose());
    const Matrix3d answers = R_base_tip * phi.template rightCols<3>();
    const Matrix3d A = -inverse_left_jacobian(e) - inverse_right_jacobian(e) * answers;
    const auto lu = A.partialPivLu();
    const Vector3d delta = -lu.solve(e);
    if (!(delta.norm() < 0.5)) return {.converged = false, .evaluations = i};
    if (delta.norm() < tangent_suffices_rad) {
      solution.turn = lu.solve(R_base_tip * phi.template leftCols<N>());
      solution.determinant = (-A).determinant();
      finish<N>(delta, solution);
      return {.converged = true, .evaluations = i};
    }
    Q = Q * exp_so3(delta);
  }
  return {.converged = false, .evaluations = kMostIntegrations};
}

template DeadLoadSolution<3> make_dead_load_solution<3>(const RodSolver&);
template DeadLoadSolution<6> make_dead_load_solution<6>(const RodSolver&);
template DeadLoadSolution<9> make_dead_load_solution<9>(const RodSolver&);
template DeadLoadSolution<12> make_dead_load_solution<12>(const RodSolver&);
template WeightedSolve solve_dead_load<3>(const RodSolver&, const DeadLoad&, const DeadLoadDirections<3>&,
                                          const Matrix3d&, DeadLoadSolution<3>&, double);
template WeightedSolve solve_dead_load<6>(const RodSolver&, const DeadLoad&, const DeadLoadDirections<6>&,
                                          const Matrix3d&, DeadLoadSolution<6>&, double);
template WeightedSolve solve_dead_load<9>(const RodSolver&, const DeadLoad&, const DeadLoadDirections<9>&,
                                          const Matrix3d&, DeadLoadSolution<9>&, double);
template WeightedSolve solve_dead_load<12>(const RodSolver&, const DeadLoad&, const DeadLoadDirections<12>&,
                                           const Matrix3d&, DeadLoadSolution<12>&, double);

}  // namespace palpate
