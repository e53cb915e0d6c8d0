// SPDX-License-Identifier: Apache-2.0
#include <palpate/rod/march_lanes.hpp>

void palpate::rod_lanes::march_baseline(const MarchPiece& piece, bool full, int columns, const MarchField& field,
                                        MarchState& state, MarchRecord* before, MarchRecord* after) {
  using T = xsimd::batch<double, xsimd::default_arch>;
  (full ? march<true, T, T> : march<false, T, T>)(piece, columns, field, state, before, after);
}
