// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdio>
#include <palpate/batch/batch.hpp>
#include <palpate/math/units.hpp>
#include <random>

/// One shaft under 100 000 tip forces at once: where does the tip go?
int main() {
  using namespace palpate;
  const Rod rod = uniform_rod(0.070, {0.2612e-3, 0.16664e-3, 0.1645e-3}, {24.57, 0.0, 0.0});
  const RodSolver solver(rod, {});

  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> component_N(-0.1, 0.1);
  std::vector<Vector3d> force_tip_N(100'000);
  for (Vector3d& force : force_tip_N) force = {component_N(random), component_N(random), component_N(random)};

  BatchSolution solution;  // keep it: solved again with as many rods it allocates nothing
  const auto start = std::chrono::steady_clock::now();
  solve_batch(solver, {.force_tip_N = force_tip_N}, {}, solution);
  const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;

  RodSolution<0> unloaded = solver.make_solution<0>();
  solver.solve({}, unloaded);
  const Eigen::VectorXd moved_m =
      (solution.tip.p_base_local_m.colwise() - unloaded.T_base_tip.p).colwise().norm().transpose();
  std::printf("%td rods, %.2f us each\n", moved_m.size(), took.count() / static_cast<double>(moved_m.size()));
  std::printf("the tip moves by %.1f mm in the mean, %.1f mm at most\n", kMillimetresPerMetre * moved_m.mean(),
              kMillimetresPerMetre * moved_m.maxCoeff());
  return 0;
}
