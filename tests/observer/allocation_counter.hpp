// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace palpate::test {

/// Counts the heap allocations of this thread while it lives: operator new, malloc and its relatives. One at a time.
class CountAllocations {
 public:
  CountAllocations();
  ~CountAllocations();
  CountAllocations(const CountAllocations&) = delete;
  CountAllocations& operator=(const CountAllocations&) = delete;
  std::size_t so_far() const;
};

}  // namespace palpate::test
