// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>
#include <iostream>
#include <palpate/batch/batch.hpp>
#include <string>
#include <vector>

/// The C++ side of batch.py: reads forces once (binary, n x 3 doubles from the file named), then for every line on
/// standard input solves them all and prints the seconds that took, with a sum over the result.
namespace palpate {
namespace {

std::vector<Vector3d> read_forces(const char* path) {
  std::vector<Vector3d> forces;
  std::FILE* file = std::fopen(path, "rb");
  Vector3d force;
  while (file && std::fread(force.data(), sizeof(double), 3, file) == 3) forces.push_back(force);
  if (file) std::fclose(file);
  return forces;
}

/// reuse: into the same memory every time; else into new memory, as a function that returns its result does.
void serve(const std::vector<Vector3d>& force_N, bool sensitivities, bool reuse) {
  const RodSolver solver(uniform_rod(0.07, {0.2612e-3, 0.16664e-3, 0.1645e-3}, {24.57, 0.0, 0.0}), {});
  BatchSolution kept;
  for (std::string line; std::getline(std::cin, line);) {
    const auto start = std::chrono::steady_clock::now();
    BatchSolution fresh;
    BatchSolution& solution = reuse ? kept : fresh;
    solve_batch(solver, {.force_tip_N = force_N}, {.force_sensitivities = sensitivities}, solution);
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    fmt::print("{:.9f} {:.17g}\n", spent.count(), solution.tip.p_base_local_m.sum());
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  palpate::serve(palpate::read_forces(argv[1]), argv[2][0] == '1', argv[3][0] == '1');
}
