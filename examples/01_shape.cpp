// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <palpate/math/units.hpp>
#include <palpate/rod/statics.hpp>

/// The shape of a shaft under a force on its tip, and how far the tip yields to a little more force. The frame: clamp
/// at the origin, z along the straight shaft. The force is in axes of the tip: x, y across, z along the tangent.
int main() {
  using namespace palpate;
  // 70 mm long; bending about x and y, torsion [N m^2]; bent to 24.57 1/m about x (the paper's catheter).
  const Rod rod = uniform_rod(0.070, {0.2612e-3, 0.16664e-3, 0.1645e-3}, {24.57, 0.0, 0.0});
  const double stations_m[] = {0.0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07};
  const RodSolver solver(rod, stations_m);

  // Work space is made once, and every solution after that takes microseconds and no memory.
  RodSolution<3> shape = solver.make_solution<3>();
  LoadDirections<3> along_force;
  along_force.force_tip_N = Matrix3d::Identity();
  const TipLoad load = {.force_tip_N = {0.02, 0.0, -0.10}};  // 10 g press against the tip, 2 g push it aside
  solver.solve(load, along_force, shape);

  std::printf("  s [mm]    x [mm]    y [mm]    z [mm]   bend [1/m]\n");
  for (std::size_t i = 0; i < shape.points.size(); ++i) {
    const Vector3d p_mm = kMillimetresPerMetre * shape.points[i].T_base_local.p;
    std::printf("%8.1f  %8.3f  %8.3f  %8.3f  %8.2f\n", kMillimetresPerMetre * stations_m[i], p_mm.x(), p_mm.y(),
                p_mm.z(), shape.points[i].curvature_per_m.x());
  }
  const Matrix3d& yield_m_per_N = shape.tangents.back().position_m;
  std::printf("One more gram-force along the tip's x, y, z moves it by %.2f, %.2f, %.2f mm.\n",
              kMillimetresPerMetre / kGramsForcePerNewton * yield_m_per_N.col(0).norm(),
              kMillimetresPerMetre / kGramsForcePerNewton * yield_m_per_N.col(1).norm(),
              kMillimetresPerMetre / kGramsForcePerNewton * yield_m_per_N.col(2).norm());
  return 0;
}
