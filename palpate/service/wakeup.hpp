// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace palpate::service {

/// Wakes a thread that waits (eventfd). notify() from any thread: it neither blocks nor allocates.
class Wakeup {
 public:
  /// Throws std::system_error where the system has no descriptor left.
  Wakeup();
  ~Wakeup();
  Wakeup(const Wakeup&) = delete;
  Wakeup& operator=(const Wakeup&) = delete;

  void notify() noexcept;
  /// Until the next notify(), or for so long at most. Notifications since the last call count.
  void wait(std::int64_t longest_ns) noexcept;
  void clear() noexcept;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

}  // namespace palpate::service
