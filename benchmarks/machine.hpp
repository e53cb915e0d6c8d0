// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <benchmarks/latency_record.hpp>
#include <chrono>
#include <ctime>

/// What the latency run asks of the system: clocks, a core, memory that stays, and what it did to the thread.
namespace palpate::latency {

inline double thread_us() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
}

struct Times {
  float wall_us = 0.0F, cpu_us = 0.0F;
};

/// Calls `step` between the clocks. The thread's clock costs a system call and stays outside the other's.
template <class Step>
Times timed(const Step& step) {
  using Clock = std::chrono::steady_clock;
  const double cpu_start_us = thread_us();
  const Clock::time_point start = Clock::now();
  step();
  const Clock::time_point end = Clock::now();
  return {std::chrono::duration<float, std::micro>(end - start).count(),
          static_cast<float>(thread_us() - cpu_start_us)};
}

/// Medians of what reading the clocks adds to a time.
inline Times clock_overhead() {
  std::vector<float> wall_us, cpu_us;
  for (int i = 0; i < 10'000; ++i) {
    const Times t = timed([] {});
    wall_us.push_back(t.wall_us);
    cpu_us.push_back(t.cpu_us);
  }
  return {static_cast<float>(percentile(std::move(wall_us), 0.5)),
          static_cast<float>(percentile(std::move(cpu_us), 0.5))};
}

/// Keeps the thread on one core, the one it is on where `core` is negative. The core, or -1 where the system refuses.
inline int pin(int core) {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  CPU_SET(core >= 0 ? core : sched_getcpu(), &cores);
  return sched_setaffinity(0, sizeof cores, &cores) == 0 ? sched_getcpu() : -1;
}

/// Keeps what the program has in memory there. False where the system refuses.
inline bool lock_memory() { return mlockall(MCL_CURRENT) == 0; }

inline rusage usage() {
  rusage u{};
  getrusage(RUSAGE_THREAD, &u);
  return u;
}

}  // namespace palpate::latency
