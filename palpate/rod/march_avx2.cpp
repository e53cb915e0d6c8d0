// SPDX-License-Identifier: Apache-2.0
#include <palpate/rod/march_lanes.hpp>

void palpate::rod_lanes::march_avx2(const MarchPiece& piece, bool full, int columns, const MarchField& field,
                                    MarchState& state, MarchRecord* before, MarchRecord* after) {
  using T = xsimd::batch<double, xsimd::fma3<xsimd::avx2>>;
  (full ? march<true, T, T> : march<false, T, T>)(piece, columns, field, state, before, after);
}
