// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdlib>
#include <thread>

/// Waiting, always with an end: no test may hang.
namespace palpate::serve_test {

using Clock = std::chrono::steady_clock;

inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

inline void sleep_s(double duration_s) { std::this_thread::sleep_for(std::chrono::duration<double>(duration_s)); }

/// False where it does not hold within so many seconds.
template <typename Condition>
[[nodiscard]] bool eventually(const Condition& holds, double longest_s, double look_every_s = 0.002) {
  const Clock::time_point start = Clock::now();
  while (!holds()) {
    if (seconds_since(start) > longest_s) return false;
    sleep_s(look_every_s);
  }
  return true;
}

/// PALPATE_LONG=1: every test in its full form, some twenty minutes instead of one.
inline bool in_full() {
  const char* const wanted = std::getenv("PALPATE_LONG");
  return wanted != nullptr && *wanted == '1';
}

}  // namespace palpate::serve_test
