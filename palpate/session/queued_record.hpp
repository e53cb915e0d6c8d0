// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/session/live_record.hpp>
#include <palpate/session/writer.hpp>

namespace palpate::session {

/// A record on its way from the thread that offers it to the one that writes.
struct QueuedRecord {
  LiveRecord record;
  bool counts = true;  ///< was offered; false: the writer's own
};

/// Records that found no room, one after the other.
struct Drops {
  std::uint64_t count = 0;
  std::int64_t from_ns = 0, to_ns = 0;
  void add(std::int64_t received_ns) {
    if (count++ == 0) from_ns = received_ns;
    to_ns = received_ns;
  }
};

/// As large as a record of these catheters gets, so that filling a copy of it does not allocate.
QueuedRecord roomy_record(const std::vector<SessionCatheter>& catheters);

/// Only what is kept of this kind: an old text in a record that is used again is not copied with every frame.
void fill(LiveRecord& slot, const LiveRecord& record);
/// The event "dropped" that stands for them.
void fill(LiveRecord& slot, const Drops& drops);

}  // namespace palpate::session
