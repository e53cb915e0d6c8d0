// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <palpate/identification/precurvature.hpp>

/// Links palpate::identification. Points of an arc of 20 1/m, which a catheter believed straight must be given. A
/// curvature k1 turns the tangent about d1, which moves the shaft along -d2.
int main() {
  const double curvature_per_m = 20.0;
  palpate::Catheter catheter;
  catheter.rod = palpate::uniform_rod(0.07, {2.6e-4, 1.7e-4, 1.6e-4}, palpate::Vector3d::Zero());
  palpate::ArcData data;
  data.point_sigma_m = 1e-4;
  for (int i = 1; i <= 7; ++i) {
    const double s_m = 0.01 * i, angle = curvature_per_m * s_m;
    data.points.push_back({s_m, {0.0, -(1.0 - std::cos(angle)) / curvature_per_m, std::sin(angle) / curvature_per_m}});
  }
  const palpate::ArcFit fit = palpate::fit_arc(catheter, data);
  std::printf("k1,0 = %.4f 1/m, k2,0 = %.4f 1/m\n", fit.precurvature_per_m.x(), fit.precurvature_per_m.y());
  const palpate::Vector3d off_per_m = fit.precurvature_per_m - palpate::Vector3d(curvature_per_m, 0.0, 0.0);
  return fit.converged && off_per_m.head<2>().norm() < 1e-3 ? 0 : 1;
}
