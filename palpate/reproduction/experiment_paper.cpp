// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <numbers>
#include <palpate/reproduction/experiment_scenarios.hpp>

/// Section 5 and Table 7 of the paper, and what they leave open.
namespace palpate::reproduction {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

PaperError axial(double mean_N, double sigma_N) {
  return {{kUnknown, kUnknown, mean_N}, {kUnknown, kUnknown, sigma_N}};
}

Experiment planar_weight() {
  Experiment e;
  e.name = "I (a)";
  e.set_up =
      "13.03 g over a pulley, swung in the plane of the bend by 70 degrees to either side of -e2, 10 s a swing; 30 s "
      "at 40 Hz";
  e.precurvature_per_m = 39.99;
  e.swing_N = 0.06;
  e.swing_rad_per_s = kTwoPi / 10.0;
  e.paper = {{{{1.03e-4, 3.09e-4, 6.5e-3}, {0.002, 5.8e-3, 0.0202}},
              {{3.86e-5, 5.88e-4, 1.6e-3}, {4.23e-4, 2.8e-3, 5.4e-3}},
              {{6.01e-6, 5.03e-5, 1.7e-3}, {4.36e-6, 9.67e-5, 5.2e-3}}}};
  return e;
}

Experiment spatial_weight() {
  Experiment e;
  e.name = "I (b)";
  e.set_up =
      "the same weight, the pulley swung in space by two links: 40 degrees in the plane of the bend in 10 s, 50 "
      "degrees "
      "out of it in 14 s; 30 s at 40 Hz";
  e.precurvature_per_m = 24.57;
  e.swing_N = 0.03;
  e.swing_rad_per_s = kTwoPi / 10.0;
  e.paper = {{{{2.71e-4, 2.38e-4, 0.003}, {6.9e-3, 5.4e-3, 0.0174}},
              {{4.86e-4, 2.82e-4, 7.65e-4}, {3.7e-3, 2.6e-3, 4.5e-3}},
              {{4.38e-6, 9.26e-5, 3.10e-4}, {1.06e-5, 1.65e-4, 0.003}}}};
  return e;
}

Experiment pushed_by_hand() {
  Experiment e;
  e.name = "II (a)";
  e.set_up =
      "a stiff plate against which the tip does not slip, pushed by hand towards the clamp, 2 s a push and seven holds "
      "of 3 s; water pushes at the tip with 0.5 mN rms an axis, alike for 0.3 s; 34 s at 40 Hz";
  e.precurvature_per_m = 19.41;
  e.repeats = 5;
  e.duration_s = 34.0;
  e.curvature_factor = 2.0;
  e.water = true;
  e.swing_N = 0.015;  // a push: half a swing
  e.swing_rad_per_s = kTwoPi / 4.0;
  e.paper = {{{{9.4e-3, 0.0181, 0.0375}, {2.4e-3, 9.8e-3, 0.0133}},
              {{0.003, 4.8e-3, 0.0055}, {7.01e-4, 1.4e-3, 0.002}},
              {{7.39e-5, 5.42e-4, 0.0028}, {5.55e-5, 2.70e-4, 0.0019}}}};
  return e;
}

Experiment pushed_by_motors() {
  Experiment e;
  e.name = "II (b)";
  e.set_up =
      "the same plate and water, moved by motors at 0.21 Hz, k1,0 as in II (a) (not stated); 60 s, a frame every 0.3 "
      "s; stiffness estimated too, EI known to 5 % beforehand";
  e.precurvature_per_m = 19.41;
  e.repeats = 5;
  e.duration_s = 60.0;
  e.rate_hz = 1.0 / 0.3;
  e.curvature_factor = 2.0;
  e.water = true;
  e.swing_N = 0.045;
  e.swing_rad_per_s = kTwoPi * 0.21;
  e.with_stiffness = true;
  e.paper = {axial(kUnknown, kUnknown), axial(0.0138, 0.0050), axial(0.0035, 0.0012)};
  return e;
}

}  // namespace

const Experiment& experiment(ExperimentId id) {
  static const std::array all = {planar_weight(), spatial_weight(), pushed_by_hand(), pushed_by_motors()};
  return all[static_cast<std::size_t>(id)];
}

}  // namespace palpate::reproduction
