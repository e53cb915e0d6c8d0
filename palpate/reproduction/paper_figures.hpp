// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

/// What the paper prints, spelled once (Sensors 2016, 16, 990). Forces in N, in the order e(Fx), e(Fy), e(Fz).
namespace palpate::reproduction::paper {

inline constexpr std::array<const char*, 3> kMethods{"EKF", "IEKF", "IAEKF"};  ///< order of every table below

struct Errors {
  std::array<double, 3> max_abs{}, mean{}, std{};
};

inline constexpr std::array<Errors, 3> kTable3{{
    {{3.237e-4, 0.0011, 0.0774}, {1.124e-5, -7.355e-6, 0.0039}, {5.521e-5, 1.859e-4, 0.0122}},
    {{3.147e-5, 3.992e-5, 0.0048}, {1.957e-6, 1.070e-6, 2.013e-4}, {1.209e-5, 1.361e-5, 7.917e-4}},
    {{1.436e-7, 6.957e-7, 2.488e-5}, {9.747e-9, 4.560e-8, 1.480e-6}, {3.147e-8, 1.436e-7, 6.814e-6}},
}};

inline constexpr std::array<double, 5> kTable4Factors{0.02, 0.1, 1.0, 10.0, 50.0};  ///< of R
inline constexpr std::array<std::array<double, 5>, 3> kTable4{{
    {0.0164, 0.0160, 0.0144, 0.0113, 0.0079},
    {3.237e-6, 1.304e-6, 6.849e-6, 2.216e-5, 4.257e-5},
    {2.878e-7, 4.471e-7, 1.296e-6, 1.539e-5, 4.641e-5},
}};

/// Started at 0.2 and at 0.5 of the largest true force.
inline constexpr std::array<double, 2> kTable5Shares{0.2, 0.5};
inline constexpr std::array<std::array<Errors, 2>, 3> kTable5{{
    {{{{}, {-3.17e-7, -1.11e-5, -0.0102}, {1.054e-7, 1.95e-5, 0.0091}},
      {{}, {-1.01e-5, -3.19e-5, -0.0273}, {2.5e-5, 3.83e-5, 0.0170}}}},
    {{{{}, {2.93e-7, 8.90e-8, 4.06e-5}, {2.19e-6, 3.60e-6, 1.70e-4}},
      {{}, {2.72e-6, -1.80e-6, 2.06e-6}, {2.04e-6, 3.63e-6, 1.74e-4}}}},
    {{{{}, {-6.63e-9, -3.19e-8, -2.13e-5}, {6.056e-8, 2.11e-7, 3.04e-4}},
      {{}, {2.70e-9, 2.08e-8, -3.12e-5}, {1.06e-8, 1.98e-7, 1.91e-4}}}},
}};

/// Seconds an update: CFE, CFSE. MATLAB 2013a, Core i3 2.2 GHz, l_i = 10, M = 15.
inline constexpr std::array<std::array<double, 3>, 2> kTable6_s{{{0.029, 0.11, 0.175}, {0.049, 0.176, 0.28}}};

/// Section 4.4, of IEKF and IAEKF: largest average force error with its spread, and error of the stiffness.
inline constexpr std::array<std::array<double, 2>, 2> kFigure7Force_N{{{-0.0016, 0.0036}, {0.0008, 0.0054}}};
inline constexpr std::array<double, 2> kFigure7Stiffness_Nm2{-1.59e-4, 1.28e-5};

}  // namespace palpate::reproduction::paper
