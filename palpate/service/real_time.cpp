// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <palpate/service/real_time.hpp>

namespace palpate::service {

std::string ask_for_priority(int priority) {
  const sched_param wanted{priority};
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted);
  if (error == 0) return {};
  return fmt::format("service.real_time_priority = {}: refused: {}; it takes root, CAP_SYS_NICE or a limit rtprio",
                     priority, std::strerror(error));
}

void stand_back() {
  constexpr int kNice = 10;
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);  // Linux: of this thread alone
}

std::string ask_for_locked_memory() {
  // Under a limit, locking what is there would make later allocations fail.
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  if (limit.rlim_cur == RLIM_INFINITY && mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return {};
  const std::string why = limit.rlim_cur == RLIM_INFINITY ? std::strerror(errno) : "the limit memlock is not unlimited";
  return fmt::format("service.lock_memory: refused: {}; it takes root, CAP_IPC_LOCK or a limit memlock", why);
}

}  // namespace palpate::service
