// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <palpate/identification/stiffness.hpp>
#include <palpate/math/units.hpp>
#include <palpate/rod/base_loads.hpp>
#include <random>
#include <stdexcept>

#include "tests/rod/rod_cases.hpp"

/// Virtual load cases: the truth's shapes come from continuation at reference accuracy, the fit's from Newton's method.
namespace palpate::test {

inline Catheter catheter_of(const Rod& rod) {
  Catheter catheter;
  catheter.name = "virtual";
  catheter.rod = rod;
  return catheter;
}

/// What a bench has: clamp good to 0.3 mm and 0.3 deg, bend of the unloaded shaft good to 0.5 1/m.
inline Catheter with_uncertain_setup(Catheter catheter) {
  catheter.base.position_sigma_m = 0.3e-3;
  catheter.base.rotation_sigma_rad = 0.3 * kRadiansPerDegree;
  catheter.precurvature_sigma_per_m = {0.5, 0.5, 0.2};
  return catheter;
}

/// Ten dead weights of 0.03 to 0.12 N in varied directions, more across the shaft than along it.
inline std::vector<Vector3d> ten_forces_N() {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<Vector3d> forces;
  for (int i = 0; i < 10; ++i) {
    const double x = normal(random), y = normal(random), z = 0.5 * normal(random);
    forces.push_back((0.03 + 0.01 * i) * Vector3d(x, y, z).normalized());
  }
  return forces;
}

inline std::vector<double> every_centimetre(const Rod& rod) {
  std::vector<double> s;
  for (int i = 1; 0.01 * i < rod.length_m() + 1e-9; ++i) s.push_back(std::min(0.01 * i, rod.length_m()));
  return s;
}

/// Shapes at the places under each force, as the base frame sees a clamp that stands at T_base_clamp. Exact.
inline std::vector<LoadCase> hang(const Rod& rod, const std::vector<Vector3d>& forces_N,
                                  const std::vector<double>& arc_lengths_m, double stated_sigma_m,
                                  const Pose& T_base_clamp = {}) {
  Rod seen = rod;
  seen.distributed_load_base_N_per_m = T_base_clamp.R.transpose() * rod.distributed_load_base_N_per_m;
  const RodSolver solver(seen, arc_lengths_m, Accuracy::kReference);
  const RodSolver bare(seen, std::vector<double>{}, Accuracy::kReference);
  auto shape = solver.make_solution<0>();
  std::vector<LoadCase> cases;
  for (const Vector3d& force : forces_N) {
    const Equilibrium equilibrium =
        follow_from_rest(bare, {.force_base_N = T_base_clamp.R.transpose() * force, .tip = {}});
    if (equilibrium.load_factor < 1.0) throw std::runtime_error("no equilibrium under this load");
    solver.solve(equilibrium.load, shape);
    LoadCase one{.name = "load " + std::to_string(cases.size() + 1), .force_base_N = force, .points = {}};
    for (std::size_t i = 0; i < arc_lengths_m.size(); ++i) {
      ShapePoint point;
      point.arc_length_m = arc_lengths_m[i];
      point.position_base_m = T_base_clamp * shape.points[i].T_base_local.p;
      point.sigma_m.setConstant(stated_sigma_m);
      one.points.push_back(point);
    }
    cases.push_back(one);
  }
  return cases;
}

inline Vector3d normal3(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random), z = normal(random);
  return {x, y, z};
}

inline std::vector<LoadCase> with_noise(std::vector<LoadCase> cases, double sigma_m, std::mt19937_64& random) {
  for (LoadCase& one : cases)
    for (ShapePoint& point : one.points) point.position_base_m += sigma_m * normal3(random);
  return cases;
}

inline void scale_stiffness(Rod& rod, const Vector3d& factor) {
  for (Section& section : rod.sections) section.stiffness_Nm2 = section.stiffness_Nm2.cwiseProduct(factor);
}

/// Of an unknown stiffness: how far from the truth, relative.
inline double relative_error(const StiffnessUnknown& found, double truth) {
  return std::abs(found.value / truth - 1.0);
}

}  // namespace palpate::test
