// SPDX-License-Identifier: Apache-2.0
#include <palpate/rod/march_lanes.hpp>

// Four lanes with the registers of AVX-512; a type that no other kernel uses.
void palpate::rod_lanes::march_avx512(const MarchPiece& piece, bool full, int columns, const MarchField& field,
                                      MarchState& state, MarchRecord* before, MarchRecord* after) {
  using Narrow = xsimd::batch<double, xsimd::avx2>;
  using Wide = xsimd::batch<double, xsimd::avx512f>;
  (full ? march<true, Narrow, Wide> : march<false, Narrow, Wide>)(piece, columns, field, state, before, after);
}
