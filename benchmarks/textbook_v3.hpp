// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

/// The yardstick compiled for x86-64-v3 (AVX2 and FMA, contracted), so that nobody need ask what the compiler's flags
/// alone are worth. Its file is built with Eigen and palpate renamed: no function of it is shared with the rest of the
/// program, which is built for an older processor. Hence plain numbers on this border, matrices by columns.
namespace textbook_v3 {

struct Shaft {
  double length_m, behind_m;
  std::array<double, 3> stiffness_Nm2, precurvature_per_m;
};

/// T_base_local of the sensor at the tip and of the one behind it.
struct SensorPoses {
  std::array<double, 9> R_tip, R_behind;
  std::array<double, 3> p_tip_m, p_behind_m;
};

struct Belief {
  std::array<double, 3> force_tip_N;
  std::array<double, 9> covariance_N2;
};

/// As textbook::solve_rod.
SensorPoses solve_rod(const Shaft& shaft, const std::array<double, 3>& force_tip_N);

/// As textbook::iekf_update with the raw poses of both sensors.
Belief iekf_update(const Shaft& shaft, const Belief& prior, const SensorPoses& measured,
                   const std::array<double, 144>& noise_information);

}  // namespace textbook_v3
