// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <palpate/session/live_record.hpp>
#include <palpate/store/database.hpp>

/// A record to rows of the session's tables, and back. Columns as column_names() has them.
namespace palpate::session {

void bind_frame(store::Statement& row, const LiveRecord& record, std::int64_t id, std::int64_t checksum);
void bind_reading(store::Statement& row, const SensorReading& reading, std::int64_t id);
void bind_estimate(store::Statement& row, const Estimate& estimate, std::int64_t id, std::int64_t checksum);
void bind_extra(store::Statement& row, const Estimate& estimate, std::int64_t id);
void bind_event(store::Statement& row, const LiveRecord& record, std::int64_t id, std::int64_t after_frame,
                std::int64_t checksum);

/// The row at which the statement stands. False where a word or a code in it is none.
[[nodiscard]] bool take_frame(const store::Statement& row, LiveRecord& record, std::int64_t& checksum);
[[nodiscard]] bool take_reading(const store::Statement& row, SensorReading& reading);
[[nodiscard]] bool take_estimate(const store::Statement& row, Estimate& estimate, std::int64_t& checksum);
void take_extra(const store::Statement& row, Estimate& estimate);
void take_event(const store::Statement& row, LiveRecord& record, std::int64_t& after_frame, std::int64_t& checksum);

/// frame.given: 1 tendon, 2 bend (and 4: inside its map), 8 known load (and 16: in base components).
std::int64_t given_bits(const TrackerFrame& frame);
/// The numbers that come with them; zero where they are not given.
using LoadNumbers = std::array<double, 11>;
void load_numbers_of(const TrackerFrame& frame, LoadNumbers& numbers);

}  // namespace palpate::session
