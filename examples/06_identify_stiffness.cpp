// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <palpate/identification/stiffness.hpp>
#include <palpate/rod/base_loads.hpp>
#include <random>

namespace {

using namespace palpate;

/// What markers at every centimetre would show of the shaft under a dead load, with 0.28 mm of noise.
LoadCase hang_weight(const Rod& shaft, const char* name, const Vector3d& force_base_N, std::mt19937_64& random) {
  const std::vector<double> stations_m = {0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07};
  const RodSolver solver(shaft, stations_m, Accuracy::kReference);
  RodSolution<0> shape = solver.make_solution<0>();
  solver.solve(follow_from_rest(solver, {.force_base_N = force_base_N, .tip = {}}).load, shape);

  std::normal_distribution<double> noise_m(0.0, 0.28e-3);
  LoadCase load_case = {.name = name, .force_base_N = force_base_N, .points = {}};
  for (std::size_t i = 0; i < stations_m.size(); ++i) {
    ShapePoint point;
    point.arc_length_m = stations_m[i];
    point.position_base_m =
        shape.points[i].T_base_local.p + Vector3d(noise_m(random), noise_m(random), noise_m(random));
    point.sigma_m.setConstant(0.28e-3);
    load_case.points.push_back(point);
  }
  return load_case;
}

}  // namespace

/// Stiffness from hung weights: the file's is a guess, the shaft that is measured has another.
int main() {
  Catheter catheter;
  catheter.rod = uniform_rod(0.070, {0.25e-3, 0.17e-3, 0.16e-3}, Vector3d::Zero());
  const Vector3d true_Nm2(0.2821e-3, 0.1583e-3, 0.1694e-3);
  const Rod shaft = uniform_rod(0.070, true_Nm2, Vector3d::Zero());

  std::mt19937_64 random(5);
  const LoadCase cases[] = {hang_weight(shaft, "2 g along x", {0.0196, 0.0, 0.0}, random),
                            hang_weight(shaft, "2 g against x", {-0.0196, 0.0, 0.0}, random),
                            hang_weight(shaft, "3 g along y", {0.0, 0.0294, 0.0}, random),
                            hang_weight(shaft, "3 g against y", {0.0, -0.0294, 0.0}, random)};
  const StiffnessFit fit = identify_stiffness(catheter, cases);
  bool inside = fit.converged;
  for (std::size_t i = 0; i < fit.unknowns.size(); ++i) {
    const StiffnessUnknown& found = fit.unknowns[i];
    const double truth_Nm2 = true_Nm2[static_cast<Eigen::Index>(i)];
    std::printf("%s = %.4g N m^2 +- %.1f %%   (true: %.4g)\n", found.name.c_str(), found.value, 100.0 * found.log_sigma,
                truth_Nm2);
    inside = inside && std::abs(std::log(found.value / truth_Nm2)) < 4.0 * found.log_sigma;
  }
  std::printf("residuals %.2f mm rms\n", 1e3 * fit.rms_m);
  return inside ? 0 : 1;
}
