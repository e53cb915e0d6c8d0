// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <utility>

namespace palpate {

/// Explicit Runge-Kutta methods y' = f(s, y): k_i = f(s + c_i h, y + h sum_j a_ij k_j), y+ = y + h sum_i b_i k_i.
/// The order conditions are tested by convergence, and by c_i = sum_j a_ij, sum_i b_i = 1.
template <int Stages>
struct Tableau {
  static constexpr int stages = Stages;
  std::array<std::array<double, Stages>, Stages> a{};
  std::array<double, Stages> b{};

  constexpr double c(int i) const {
    double sum = 0.0;
    for (int j = 0; j < i; ++j) sum += a[i][j];
    return sum;
  }
};

/// Kutta 1901, order 4.
inline constexpr Tableau<4> kRungeKutta4{
    .a = {{{}, {0.5}, {0.0, 0.5}, {0.0, 0.0, 1.0}}},
    .b = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6},
};

/// Butcher 1964, order 6 in 7 stages.
inline constexpr Tableau<7> kButcher6{
    .a = {{{},
           {1.0 / 3},
           {0.0, 2.0 / 3},
           {1.0 / 12, 1.0 / 3, -1.0 / 12},
           {25.0 / 48, -55.0 / 24, 35.0 / 48, 15.0 / 8},
           {3.0 / 20, -11.0 / 24, -1.0 / 8, 1.0 / 2, 1.0 / 10},
           {-261.0 / 260, 33.0 / 13, 43.0 / 156, -118.0 / 39, 32.0 / 195, 80.0 / 39}}},
    .b = {13.0 / 200, 0.0, 11.0 / 40, 11.0 / 40, 4.0 / 25, 4.0 / 25, 13.0 / 200},
};

namespace detail {
inline constexpr double kRoot21 = 4.58257569495584000658804719372800848;
}

/// Cooper and Verner 1972, order 8 in 11 stages.
inline constexpr Tableau<11> kCooperVerner8 = [] {
  constexpr double w = detail::kRoot21;
  Tableau<11> t;
  t.a[1] = {1.0 / 2};
  t.a[2] = {1.0 / 4, 1.0 / 4};
  t.a[3] = {1.0 / 7, (-7 - 3 * w) / 98, (21 + 5 * w) / 49};
  t.a[4] = {(11 + w) / 84, 0, (18 + 4 * w) / 63, (21 - w) / 252};
  t.a[5] = {(5 + w) / 48, 0, (9 + w) / 36, (-231 + 14 * w) / 360, (63 - 7 * w) / 80};
  t.a[6] = {(10 - w) / 42,           0, (-432 + 92 * w) / 315, (633 - 145 * w) / 90, (-504 + 115 * w) / 70,
            (63 - 13 * w) / 35};
  t.a[7] = {1.0 / 14, 0, 0, 0, (14 - 3 * w) / 126, (13 - 3 * w) / 63, 1.0 / 9};
  t.a[8] = {1.0 / 32, 0, 0, 0, (91 - 21 * w) / 576, 11.0 / 72, (-385 - 75 * w) / 1152, (63 + 13 * w) / 128};
  t.a[9] = {1.0 / 14,           0, 0, 0, 1.0 / 9, (-733 - 147 * w) / 2205, (515 + 111 * w) / 504, (-51 - 11 * w) / 56,
            (132 + 28 * w) / 245};
  t.a[10] = {0,
             0,
             0,
             0,
             (-42 + 7 * w) / 18,
             (-18 + 28 * w) / 45,
             (-273 - 53 * w) / 72,
             (301 + 53 * w) / 72,
             (28 - 28 * w) / 45,
             (49 - 7 * w) / 18};
  t.b = {1.0 / 20, 0, 0, 0, 0, 0, 0, 49.0 / 180, 16.0 / 45, 49.0 / 180, 1.0 / 20};
  return t;
}();

/// One step of `method` on a vector-space state; `field(s, y, dy)` writes the derivative. Zero coefficients cost nothing.
template <const auto& method, class State, class Field>
inline void runge_kutta_step(double s, double h, State& y, const Field& field) {
  constexpr int stages = std::decay_t<decltype(method)>::stages;
  std::array<State, stages> k;
  State stage;
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (
        [&]<std::size_t i>() {
          stage = y;
          [&]<std::size_t... J>(std::index_sequence<J...>) {
            (
                [&]<std::size_t j>() {
                  if constexpr (method.a[i][j] != 0.0) stage += (h * method.a[i][j]) * k[j];
                }.template operator()<J>(),
                ...);
          }(std::make_index_sequence<i>{});
          constexpr double c = method.c(i);
          field(s + c * h, stage, k[i]);
        }.template operator()<I>(),
        ...);
    (
        [&]<std::size_t i>() {
          if constexpr (method.b[i] != 0.0) y += (h * method.b[i]) * k[i];
        }.template operator()<I>(),
        ...);
  }(std::make_index_sequence<stages>{});
}

}  // namespace palpate
