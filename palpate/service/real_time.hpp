// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate::service {

/// This thread before all others (SCHED_FIFO). Empty, or why the system refuses: it is then as any other thread.
std::string ask_for_priority(int priority);

/// This thread behind all others of the process (nice 10).
void stand_back();

/// No page of this process is ever swapped out. Empty, or why the system refuses.
std::string ask_for_locked_memory();

}  // namespace palpate::service
