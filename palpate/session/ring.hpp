// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <vector>

namespace palpate::session {

/// A bounded queue between one thread that puts in and one that takes out, without a lock. Its slots are made once and
/// assigned to again and again, so that what a slot has allocated stays with it: that is why it is none of the queues
/// of a library, which build and destroy what they hold.
template <class Slot>
class Ring {
 public:
  /// `slots` is rounded up to a power of two.
  explicit Ring(std::size_t slots) : slots_(std::bit_ceil(slots)), mask_(slots_.size() - 1) {}
  /// `prototype`: what every slot is at first.
  Ring(std::size_t slots, const Slot& prototype) : slots_(std::bit_ceil(slots), prototype), mask_(slots_.size() - 1) {}

  /// The slot to fill, or null where all are taken; push() hands it over. Putting thread alone.
  Slot* free_slot() {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    return head - tail_.load(std::memory_order_acquire) > mask_ ? nullptr : &slots_[head & mask_];
  }
  void push() { head_.store(head_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }

  /// The oldest slot but `skipped`, or null where there is none; pop() gives the oldest `count` back. Taking thread
  /// alone: what it has looked at stays until it says so, and can be looked at again.
  Slot* front(std::size_t skipped = 0) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    return head_.load(std::memory_order_acquire) - tail <= skipped ? nullptr : &slots_[(tail + skipped) & mask_];
  }
  void pop(std::size_t count = 1) {
    tail_.store(tail_.load(std::memory_order_relaxed) + count, std::memory_order_release);
  }

  std::size_t capacity() const { return slots_.size(); }
  /// From any thread; may be old by the time it is read.
  std::size_t size() const {
    const std::size_t tail = tail_.load(std::memory_order_acquire);
    return head_.load(std::memory_order_acquire) - tail;
  }

 private:
  static constexpr std::size_t kCacheLine = 64;
  std::vector<Slot> slots_;
  std::size_t mask_;
  alignas(kCacheLine) std::atomic<std::size_t> head_{0};
  alignas(kCacheLine) std::atomic<std::size_t> tail_{0};
};

}  // namespace palpate::session
