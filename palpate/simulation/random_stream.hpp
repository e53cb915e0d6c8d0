// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>

namespace palpate {

/// Independent sources of chance under one seed: what one of them draws moves none of the others. ErrorTracker has its
/// own.
enum class RandomStream : std::uint32_t { kHeart = 1, kFlow = 2, kTendon = 3 };

inline std::mt19937_64 random_engine(std::uint64_t seed, RandomStream stream) {
  std::seed_seq words{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                      static_cast<std::uint32_t>(stream)};
  return std::mt19937_64(words);
}

}  // namespace palpate
