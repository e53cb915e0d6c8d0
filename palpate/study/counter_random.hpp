// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// Chance by counting: the i-th draw is a function of i, so that it depends on no draw before it, on no worker and on
/// no order.
namespace palpate::study {

/// A bijection of 64 bits in which every input bit moves every output bit. Finaliser of splitmix64: Steele, Lea and
/// Flood, "Fast splittable pseudorandom number generators", 2014.
constexpr std::uint64_t mix(std::uint64_t z) {
  z += 0x9E3779B97F4A7C15ULL;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}
constexpr std::uint64_t mix(std::uint64_t key, std::uint64_t counter) { return mix(mix(key) ^ counter); }

/// In [0, 1).
constexpr double unit(std::uint64_t bits) { return static_cast<double>(bits >> 11U) * 0x1p-53; }

/// The i-th element of a permutation of 0 .. n-1 that `key` chooses; nothing is stored. Twelve rounds of a Feistel
/// network over the next power of four, walked on until it is below n (fewer than four steps, mean). Precondition: i <
/// n.
std::uint64_t permuted(std::uint64_t i, std::uint64_t n, std::uint64_t key);

/// The i-th of n points of one axis of a Latin hypercube in [0, 1): one in every n-th part.
double latin_coordinate(std::uint64_t i, std::uint64_t n, std::uint64_t key);

}  // namespace palpate::study
