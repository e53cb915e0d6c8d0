// SPDX-License-Identifier: Apache-2.0
#include <palpate/batch/lane_kernel.hpp>

void palpate::rod_lanes::solve_baseline(const Plan& plan, Kind kind, const Loads& loads, const Row* steps, int lanes,
                                        Point* points) {
  solve<xsimd::batch<double, xsimd::default_arch>>(plan, kind, loads, steps, lanes, points);
}
