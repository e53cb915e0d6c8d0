// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <palpate/observer/estimate.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <string>

namespace palpate::session {

/// What leaves the observer's thread, for every sink alike: a frame with its estimate, or something that was said or
/// done. One object is reused for many records: copying it into another allocates only where a text or a list of
/// readings is longer than any before.
struct LiveRecord {
  enum class Kind : std::uint8_t {
    kFrame,  ///< `frame`, and `estimate` of it
    kStale,  ///< no frame has come for too long: `estimate` is the forecast, its status EstimateStatus::kStale
    kEvent,  ///< `event` and `data`
  };

  Kind kind = Kind::kFrame;
  int catheter = 0;              ///< index into the session's catheters; an event of all of them: -1
  std::int64_t received_ns = 0;  ///< the host's clock when it came [ns since 1970, UTC]; never runs back
  double output_time_s = 0.0;    ///< the time that goes out with the estimate [s since 1970, UTC]; never runs back
  double late_s = 0.0;           ///< how old a frame was when it came, as far as that can be told; not recorded
  TrackerFrame frame = {};       ///< its time_s: the device's clock, as it was sent
  Estimate estimate = {};
  std::string event = {};  ///< "tare", "base", "tendon", "note", "stale", "live", "connected", ...
  std::string data = {};   ///< JSON; what a replay needs to do the same again, numbers with all their digits
};

}  // namespace palpate::session
