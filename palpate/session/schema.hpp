// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <palpate/session/live_record.hpp>
#include <palpate/session/writer.hpp>
#include <palpate/store/database.hpp>
#include <string>
#include <string_view>
#include <vector>

/// What a session file looks like inside (docs/reference/session.md).
namespace palpate::session {

/// PRAGMA application_id of a session: "PalS".
inline constexpr std::int64_t kApplication = 0x50616C53;

/// Every step from an empty file to the newest tables (Database::migrate).
std::span<const std::string_view> schema_steps();
/// The version that this program writes, and reads at most.
std::int64_t schema_version();

/// `INSERT INTO table (...) VALUES (?, ...)` and `SELECT ... FROM table WHERE id >= ? AND id <= ? ORDER BY id`, in the
/// order in which row_codec.hpp has the columns.
enum class Table : std::uint8_t { kFrame, kReading, kEstimate, kExtra, kEvent };
inline constexpr std::size_t kTables = 5;
std::string_view table_name(Table table);
const std::string& insert_sql(Table table);
const std::string& select_sql(Table table);
/// Names of a table's columns, id first.
const std::vector<std::string>& column_names(Table table);

/// Readings have no index: the id of each is made of its frame's and its place in it.
inline constexpr std::int64_t kReadingsPerFrame = 16;

/// Writes what stands at the head of a session.
void write_head(const store::Database& database, const std::vector<SessionCatheter>& catheters,
                const WriterOptions& options);

/// Of every number, word and text of a frame with its readings, or of an event, as it is kept: tells a row of which a
/// bit has fallen.
std::int64_t checksum(const LiveRecord& record, std::int64_t id);
/// The same of an estimate.
std::int64_t checksum(const Estimate& estimate, std::int64_t id);
/// The same of a catheter with its sensors; it stands in table session under this key.
std::int64_t checksum(const SessionCatheter& catheter, std::int64_t id);
std::string checksum_key(std::int64_t catheter_id);

}  // namespace palpate::session
