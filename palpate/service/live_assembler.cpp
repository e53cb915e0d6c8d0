// SPDX-License-Identifier: Apache-2.0
#include <palpate/service/live_assembler.hpp>

namespace palpate::service {

LiveAssembler::LiveAssembler(std::size_t sensors, std::int64_t hold_ns)
    : hold_ns_(hold_ns), expected_((1U << sensors) - 1U) {
  frame_.readings.resize(sensors);
}

const TrackerFrame* LiveAssembler::close_before(double time_s) {
  return open_ && !(time_s == frame_.time_s) ? close() : nullptr;
}

const TrackerFrame* LiveAssembler::put(std::size_t sensor, double time_s, const SensorReading& reading,
                                       std::int64_t now_ns) {
  const unsigned bit = 1U << sensor;
  if (!open_) {
    if (number_ > 0 && time_s == frame_.time_s && (seen_ & bit) == 0) {
      ++late_;
      expected_ |= bit;  // it is worth waiting for again
      return nullptr;
    }
    for (SensorReading& each : frame_.readings) each = {};
    frame_.time_s = time_s;
    frame_.number = number_++;
    opened_ns_ = now_ns;
    open_ = true;
    seen_ = 0;
  }
  if ((seen_ & bit) != 0) return nullptr;  // the first word counts, as in a recording
  frame_.readings[sensor] = reading;
  seen_ |= bit;
  return (expected_ & ~seen_) == 0 ? close() : nullptr;
}

const TrackerFrame* LiveAssembler::close_overdue(std::int64_t now_ns) {
  return open_ && now_ns >= deadline_ns() ? close() : nullptr;
}

const TrackerFrame* LiveAssembler::close() {
  open_ = false;
  expected_ = seen_;
  return &frame_;
}

}  // namespace palpate::service
