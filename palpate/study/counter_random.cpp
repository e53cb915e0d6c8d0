// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <palpate/study/counter_random.hpp>

namespace palpate::study {

/// Four would do for many elements; among ten some would be left where they are too often.
constexpr std::uint64_t kRounds = 12;

std::uint64_t permuted(std::uint64_t i, std::uint64_t n, std::uint64_t key) {
  const auto bits = static_cast<unsigned>(std::bit_width(n - 1) + 1) / 2;
  const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
  do {
    std::uint64_t left = i >> bits, right = i & mask;
    for (std::uint64_t round = 0; round < kRounds; ++round) {
      const std::uint64_t next = left ^ (mix(mix(key, round), right) & mask);
      left = right;
      right = next;
    }
    i = (left << bits) | right;
  } while (i >= n);
  return i;
}

double latin_coordinate(std::uint64_t i, std::uint64_t n, std::uint64_t key) {
  const double inside = unit(mix(mix(key, 1), i));
  return (static_cast<double>(permuted(i, n, mix(key, 2))) + inside) / static_cast<double>(n);
}

}  // namespace palpate::study
