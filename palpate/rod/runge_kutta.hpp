// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <type_traits>

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

/// All c_i at once.
template <int Stages>
constexpr std::array<double, Stages> nodes(const Tableau<Stages>& method) {
  std::array<double, Stages> c{};
  for (int i = 0; i < Stages; ++i) c[i] = method.c(i);
  return c;
}

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
  t.a[6] = {(10 - w) / 42, 0, (-432 + 92 * w) / 315, (633 - 145 * w) / 90, (-504 + 115 * w) / 70, (63 - 13 * w) / 35};
  t.a[7] = {1.0 / 14, 0, 0, 0, (14 - 3 * w) / 126, (13 - 3 * w) / 63, 1.0 / 9};
  t.a[8] = {1.0 / 32, 0, 0, 0, (91 - 21 * w) / 576, 11.0 / 72, (-385 - 75 * w) / 1152, (63 + 13 * w) / 128};
  t.a[9] = {1.0 / 14,
            0,
            0,
            0,
            1.0 / 9,
            (-733 - 147 * w) / 2205,
            (515 + 111 * w) / 504,
            (-51 - 11 * w) / 56,
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

/// Dormand and Prince's method of order 8 in 12 stages with the least error constants of its kind: Hairer, Norsett,
/// Wanner, Solving Ordinary Differential Equations I, section II.5 (DOP853). What the rod is integrated with, but for a
/// short piece at the tip (step_rule.hpp).
inline constexpr Tableau<12> kDormandPrince8{
    .a = {{{},
           {5.26001519587677318785587544488e-2},
           {1.97250569845378994544595329183e-2, 5.91751709536136983633785987549e-2},
           {2.95875854768068491816892993775e-2, 0.0, 8.87627564304205475450678981324e-2},
           {2.41365134159266685502369798665e-1, 0.0, -8.84549479328286085344864962717e-1,
            9.24834003261792003115737966543e-1},
           {1.0 / 27, 0.0, 0.0, 1.70828608729473871279604482173e-1, 1.25467687566822425016691814123e-1},
           {19.0 / 512, 0.0, 0.0, 1.70252211019544039314978060272e-1, 6.02165389804559606850219397283e-2, -9.0 / 512},
           {3.70920001185047927108779319836e-2, 0.0, 0.0, 1.70383925712239993810214054705e-1,
            1.07262030446373284651809199168e-1, -1.53194377486244017527936158236e-2,
            8.27378916381402288758473766002e-3},
           {6.24110958716075717114429577812e-1, 0.0, 0.0, -3.36089262944694129406857109825,
            -8.68219346841726006818189891453e-1, 2.75920996994467083049415600797e1, 2.01540675504778934086186788979e1,
            -4.34898841810699588477366255144e1},
           {4.77662536438264365890433908527e-1, 0.0, 0.0, -2.48811461997166764192642586468,
            -5.90290826836842996371446475743e-1, 2.12300514481811942347288949897e1, 1.52792336328824235832596922938e1,
            -3.32882109689848629194453265587e1, -2.03312017085086261358222928593e-2},
           {-9.3714243008598732571704021658e-1, 0.0, 0.0, 5.18637242884406370830023853209,
            1.09143734899672957818500254654, -8.14978701074692612513997267357, -1.85200656599969598641566180701e1,
            2.27394870993505042818970056734e1, 2.49360555267965238987089396762, -3.0467644718982195003823669022},
           {2.27331014751653820792359768449, 0.0, 0.0, -1.05344954667372501984066689879e1,
            -2.00087205822486249909675718444, -1.79589318631187989172765950534e1, 2.79488845294199600508499808837e1,
            -2.85899827713502369474065508674, -8.87285693353062954433549289258, 1.23605671757943030647266201528e1,
            6.43392746015763530355970484046e-1}}},
    .b = {5.42937341165687622380535766363e-2, 0.0, 0.0, 0.0, 0.0, 4.45031289275240888144113950566,
          1.89151789931450038304281599044, -5.8012039600105847814672114227, 3.1116436695781989440891606237e-1,
          -1.52160949662516078556178806805e-1, 2.01365400804030348374776537501e-1, 4.47106157277725905176885569043e-2},
};

/// The coefficients of `method` that are not zero, stage by stage; row `Stages` is the end of the step.
template <int Stages>
struct SparseTableau {
  struct Term {
    int stage;
    double weight;
  };
  std::array<int, Stages + 1> count{};
  std::array<std::array<Term, Stages>, Stages + 1> terms{};
};

template <int Stages>
constexpr SparseTableau<Stages> sparse(const Tableau<Stages>& method) {
  SparseTableau<Stages> out;
  for (int i = 0; i <= Stages; ++i)
    for (int j = 0; j < (i < Stages ? i : Stages); ++j) {
      const double weight = i < Stages ? method.a[i][j] : method.b[j];
      if (weight != 0.0) out.terms[i][out.count[i]++] = {j, weight};
    }
  return out;
}

/// One step of `method` on a state of `blocks` times Block numbers, at most MostBlocks times; `field(s, y, dy)` writes
/// the derivative. A block's sums stay in registers. The stages are a loop, not unrolled code: twelve copies of a large
/// field would not fit the instruction cache.
template <const auto& method, int Block, int MostBlocks, class T, class Field>
[[gnu::always_inline]] inline void runge_kutta_step(const T& s, const T& h, int blocks, T* y, const Field& field) {
  constexpr int stages = std::decay_t<decltype(method)>::stages;
  static constexpr auto tableau = sparse(method);
  static constexpr auto c = nodes(method);
  T k[stages][Block * MostBlocks];
  T stage[Block * MostBlocks];
  const auto combine = [&](int i, T* out) __attribute__((always_inline)) {
    for (int first = 0; first < Block * blocks; first += Block) {
      T sum[Block];
      for (int n = 0; n < Block; ++n) sum[n] = y[first + n];
      for (int t = 0; t < tableau.count[i]; ++t) {
        const auto& term = tableau.terms[i][t];
        const T weight = h * T(term.weight);
        for (int n = 0; n < Block; ++n) sum[n] = sum[n] + weight * k[term.stage][first + n];
      }
      for (int n = 0; n < Block; ++n) out[first + n] = sum[n];
    }
  };
  for (int i = 0; i < stages; ++i) {
    combine(i, stage);
    field(s + h * T(c[i]), stage, k[i]);
  }
  combine(stages, y);
}

}  // namespace palpate
