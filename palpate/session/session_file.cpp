// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <palpate/math/errors.hpp>
#include <palpate/session/estimate_numbers.hpp>
#include <palpate/session/row_codec.hpp>
#include <palpate/session/session_file.hpp>

namespace palpate::session {

namespace {

void refuse_existing(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::exists(std::filesystem::symlink_status(path, error)))
    throw InputError(
        fmt::format("{}: exists: expected the name of a new file, for a session is never overwritten", path.string()));
}

void remove_all_of(const std::filesystem::path& path) {
  std::error_code ignored;
  for (const char* ending : {"", "-wal", "-shm", "-journal"}) std::filesystem::remove(path.string() + ending, ignored);
}

/// The last force and its sigma as numbers that read back the same; NaN has no other name in JSON.
std::string forecast_json(const Estimate& estimate) {
  const auto word = [](double value) { return std::isfinite(value) ? fmt::format("{}", value) : std::string("null"); };
  const auto list = [&](const Vector3d& v) { return fmt::format("[{},{},{}]", word(v.x()), word(v.y()), word(v.z())); };
  return fmt::format(R"({{"forecast_force_tip_N":{},"sigma_N":{}}})", list(estimate.force_tip_N),
                     list(estimate.covariance_tip_N2.diagonal().cwiseSqrt()));
}

/// The write-ahead log is brought into the file every 16 MB, and cut to as much.
constexpr std::string_view kSettings =
    "PRAGMA busy_timeout = 200; PRAGMA wal_autocheckpoint = 4000; PRAGMA journal_size_limit = 16777216;"
    "PRAGMA cache_size = -16384; PRAGMA temp_store = MEMORY;";

}  // namespace

SessionFile::SessionFile(const std::filesystem::path& path, const std::vector<SessionCatheter>& catheters,
                         const WriterOptions& options) {
  refuse_existing(path);
  lock_.emplace(path);
  refuse_existing(path);
  try {
    database_.emplace(path);
    database_->execute("PRAGMA journal_mode = WAL");
    database_->execute(options.durability == Durability::kFull ? "PRAGMA synchronous = FULL"
                                                               : "PRAGMA synchronous = NORMAL");
    database_->execute(std::string(kSettings));
    store::Transaction transaction(*database_);
    database_->execute(fmt::format("PRAGMA application_id = {}", kApplication));
    database_->migrate(schema_steps());
    write_head(*database_, catheters, options);
    transaction.commit();
    for (std::size_t i = 0; i < kTables; ++i)
      inserts_[i].emplace(database_->prepare(insert_sql(static_cast<Table>(i))));
  } catch (...) {
    for (auto& statement : inserts_) statement.reset();
    database_.reset();
    remove_all_of(path);
    throw;
  }
}

void SessionFile::begin() {
  before_batch_ = next_;
  transaction_.emplace(*database_);
}

void SessionFile::put(const LiveRecord& record) {
  if (record.kind == LiveRecord::Kind::kFrame)
    put_frame(record);
  else
    put_event(record);
}

void SessionFile::put_frame(const LiveRecord& record) {
  const std::int64_t id = next_.frame++;
  const auto& readings = record.frame.readings;
  bind_frame(insert(Table::kFrame), record, id, checksum(record, id));
  insert(Table::kFrame).run();
  const std::size_t count = std::min(readings.size(), static_cast<std::size_t>(kReadingsPerFrame));
  for (std::size_t i = 0; i < count; ++i) {
    if (readings[i].status == SensorReading::Status::kAbsent) continue;
    bind_reading(insert(Table::kReading), readings[i], kReadingsPerFrame * id + static_cast<std::int64_t>(i));
    insert(Table::kReading).run();
  }
  bind_estimate(insert(Table::kEstimate), record.estimate, id, checksum(record.estimate, id));
  insert(Table::kEstimate).run();
  if (!has_extra(record.estimate)) return;
  bind_extra(insert(Table::kExtra), record.estimate, id);
  insert(Table::kExtra).run();
}

void SessionFile::put_event(const LiveRecord& record) {
  const std::int64_t id = next_.event++;
  const auto write = [&](const LiveRecord& event) {
    bind_event(insert(Table::kEvent), event, id, next_.frame - 1, checksum(event, id));
    insert(Table::kEvent).run();
  };
  if (record.kind == LiveRecord::Kind::kEvent) return write(record);
  LiveRecord stale;
  stale.kind = LiveRecord::Kind::kEvent;
  stale.catheter = record.catheter;
  stale.received_ns = record.received_ns;
  stale.output_time_s = record.output_time_s;
  stale.event = "stale";
  stale.data = forecast_json(record.estimate);
  write(stale);
}

void SessionFile::commit() {
  transaction_->commit();
  transaction_.reset();
}

void SessionFile::roll_back() noexcept {
  for (auto& statement : inserts_) statement->abandon();  // of a row that failed: or it would hold the transaction
  transaction_.reset();
  next_ = before_batch_;
}

bool SessionFile::committed_after_all() {
  const std::int64_t frames = database_->integer("SELECT max(id) FROM frame"),
                     events = database_->integer("SELECT max(id) FROM event");
  if (frames < next_.frame && events < next_.event) return false;
  next_ = {.frame = frames + 1, .event = events + 1};
  return true;
}

void SessionFile::close() noexcept {
  for (auto& statement : inserts_) statement.reset();
  try {
    database_->execute("PRAGMA wal_checkpoint(TRUNCATE)");
    database_->execute("PRAGMA journal_mode = DELETE");  // or the file could not be read in a folder that is read-only
  } catch (const InputError&) {  // full, or somebody reads: the log stays beside the file and is read with it
  }
  database_.reset();
  lock_.reset();
}

}  // namespace palpate::session
