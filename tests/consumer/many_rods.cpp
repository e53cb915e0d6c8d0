// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <palpate/batch/batch.hpp>
#include <vector>

/// Links palpate::batch. Without a force a shaft of curvature k is an arc: its end stands (1 - cos kL) / k to the side
/// and sin(kL) / k along the clamp's axis.
int main() {
  const double curvature_per_m = 20.0, length_m = 0.07;
  const palpate::Rod rod = palpate::uniform_rod(length_m, {2.6e-4, 1.7e-4, 1.6e-4}, {curvature_per_m, 0.0, 0.0});
  const palpate::RodSolver solver(rod, {});
  const std::vector<palpate::Vector3d> forces_N(1000, palpate::Vector3d::Zero());
  palpate::BatchSolution solution;
  palpate::solve_batch(solver, {.force_tip_N = forces_N}, {}, solution);
  const double aside_m = (1.0 - std::cos(curvature_per_m * length_m)) / curvature_per_m,
               along_m = std::sin(curvature_per_m * length_m) / curvature_per_m;
  double worst_m = 0.0;
  for (Eigen::Index i = 0; i < solution.tip.p_base_local_m.cols(); ++i) {
    const palpate::Vector3d p_m = solution.tip.p_base_local_m.col(i);
    worst_m = std::fmax(worst_m, std::hypot(p_m.head<2>().norm() - aside_m, p_m.z() - along_m));
  }
  std::printf("%td rods, the worst %.1g m off the arc\n", solution.tip.p_base_local_m.cols(), worst_m);
  return solution.tip.p_base_local_m.cols() == 1000 && worst_m < 1e-6 ? 0 : 1;
}
