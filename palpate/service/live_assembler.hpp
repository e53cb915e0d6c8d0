// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <palpate/sensing/tracker_frame.hpp>

namespace palpate::service {

/// Makes frames of readings that come one by one with equal time stamps, as PLUS sends its transforms. A frame is
/// closed when every sensor of the frame before is in it, when a reading of another time comes, or when it has waited
/// for `hold`. A sensor that PLUS does not see is not sent at all: it is missing in the frame, and the next frame does
/// not wait for it any more.
class LiveAssembler {
 public:
  LiveAssembler(std::size_t sensors, std::int64_t hold_ns);

  /// The frame that was open, or null: look there before put(), which may begin the next.
  const TrackerFrame* close_before(double time_s);
  /// A reading; the frame that it completes, or null. Precondition: close_before(time_s) was called.
  const TrackerFrame* put(std::size_t sensor, double time_s, const SensorReading& reading, std::int64_t now_ns);
  /// The open frame, or null: nothing more will come of it.
  const TrackerFrame* close_now() { return open_ ? close() : nullptr; }
  /// The frame that has waited long enough, or null.
  const TrackerFrame* close_overdue(std::int64_t now_ns);

  bool open() const { return open_; }
  std::int64_t deadline_ns() const { return opened_ns_ + hold_ns_; }
  std::int64_t opened_ns() const { return opened_ns_; }  ///< when the first reading of the latest frame came
  std::uint64_t late_readings() const { return late_; }  ///< came after their frame was closed

 private:
  const TrackerFrame* close();

  TrackerFrame frame_;
  std::int64_t hold_ns_, opened_ns_ = 0, number_ = 0;
  unsigned expected_, seen_ = 0;
  bool open_ = false;
  std::uint64_t late_ = 0;
};

}  // namespace palpate::service
