// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <exception>
#include <palpate/math/units.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/output_file.hpp>
#include <palpate/rod/base_loads.hpp>
#include <random>
#include <string>

namespace {

using namespace palpate;

constexpr double kSigma_mm = 0.28;  // of every coordinate, as an electromagnetic tracker's

struct Load {
  const char* name;  ///< of the case in examples/stiffness/cases.toml
  Vector3d force_base_N;
};
const Load kLoads[] = {{"2 g along x", {0.0196, 0.0, 0.0}},
                       {"2 g against x", {-0.0196, 0.0, 0.0}},
                       {"3 g along y", {0.0, 0.0294, 0.0}},
                       {"3 g against y", {0.0, -0.0294, 0.0}}};

/// The shaft that is measured: 8 % stiffer about d1 and 5 % softer about d2 than the catheter file says.
Rod measured_shaft(Rod rod) {
  for (Section& section : rod.sections) section.stiffness_Nm2.array() *= Eigen::Array3d(1.08, 0.95, 1.03);
  return rod;
}

std::string points_under(const Rod& rod, const Load& load, std::mt19937_64& random) {
  const std::vector<double> stations_m = {0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07};
  const RodSolver solver(rod, stations_m, Accuracy::kReference);
  RodSolution<0> shape = solver.make_solution<0>();
  solver.solve(follow_from_rest(solver, {.force_base_N = load.force_base_N, .tip = {}}).load, shape);
  std::normal_distribution<double> noise_mm(0.0, kSigma_mm);
  std::string text;
  for (std::size_t i = 0; i < stations_m.size(); ++i) {
    const Vector3d mm = kMillimetresPerMetre * shape.points[i].T_base_local.p;
    char row[200];
    std::snprintf(row, sizeof row, "%s,%.1f,%.3f,%.3f,%.3f,%.2f\n", load.name, kMillimetresPerMetre * stations_m[i],
                  mm.x() + noise_mm(random), mm.y() + noise_mm(random), mm.z() + noise_mm(random), kSigma_mm);
    text += row;
  }
  return text;
}

}  // namespace

/// Writes POINTS.csv: what markers would show of a virtual shaft under the loads of examples/stiffness/cases.toml.
int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: make_load_points CATHETER.toml POINTS.csv\n");
    return 2;
  }
  try {
    const Catheter catheter = read_catheter_file(argv[1]).catheter;
    std::mt19937_64 random(5);
    std::string text = "case,arc_length_mm,x_mm,y_mm,z_mm,sigma_mm\n";
    for (const Load& load : kLoads) text += points_under(measured_shaft(catheter.rod), load, random);
    OutputFile file(argv[2]);
    file.write(text);
    file.commit();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_load_points: %s\n", error.what());
    return 2;
  }
  return 0;
}
