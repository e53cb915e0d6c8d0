// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <palpate/session/queued_record.hpp>

namespace palpate::session {

namespace {

constexpr std::size_t kEventWord = 32, kEventData = 256;  ///< texts up to so long never allocate

}  // namespace

QueuedRecord roomy_record(const std::vector<SessionCatheter>& catheters) {
  QueuedRecord slot;
  std::size_t sensors = 0;
  for (const SessionCatheter& catheter : catheters) sensors = std::max(sensors, catheter.sensor_names.size());
  slot.record.frame.readings.resize(sensors);
  slot.record.event.assign(kEventWord, ' ');
  slot.record.data.assign(kEventData, ' ');
  return slot;
}

void fill(LiveRecord& slot, const LiveRecord& record) {
  slot.kind = record.kind;
  slot.catheter = record.catheter;
  slot.received_ns = record.received_ns;
  slot.output_time_s = record.output_time_s;
  if (record.kind == LiveRecord::Kind::kEvent) {
    slot.event = record.event;
    slot.data = record.data;
    return;
  }
  slot.estimate = record.estimate;
  if (record.kind == LiveRecord::Kind::kFrame) slot.frame = record.frame;
}

void fill(LiveRecord& slot, const Drops& drops) {
  slot.kind = LiveRecord::Kind::kEvent;
  slot.catheter = -1;
  slot.received_ns = drops.to_ns;
  slot.output_time_s = 1e-9 * static_cast<double>(drops.to_ns);
  slot.event = "dropped";
  slot.data.clear();
  fmt::format_to(std::back_inserter(slot.data), R"({{"count":{},"from_ns":{},"to_ns":{}}})", drops.count, drops.from_ns,
                 drops.to_ns);
}

}  // namespace palpate::session
