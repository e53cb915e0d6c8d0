// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <palpate/session/live_record.hpp>
#include <palpate/session/schema.hpp>
#include <palpate/session/writer.hpp>
#include <palpate/store/database.hpp>
#include <palpate/store/file_lock.hpp>

namespace palpate::session {

/// A new session's file while it is being written, batch by batch. Of one thread. Every call throws InputError where
/// the disk, or another process, does not let it.
class SessionFile {
 public:
  /// Throws where the file exists; where anything fails nothing is left of it.
  SessionFile(const std::filesystem::path& path, const std::vector<SessionCatheter>& catheters,
              const WriterOptions& options);

  /// A batch: all of it once commit() has returned, nothing after roll_back() or a throw and roll_back().
  void begin();
  void put(const LiveRecord& record);
  void commit();
  void roll_back() noexcept;
  /// After a throw and roll_back(): the batch is in the file all the same, for only the answer got lost. Then it must
  /// not be written again.
  bool committed_after_all();

  /// Brings everything into the one file and lets go of it; what cannot be brought in stays beside it, and is read.
  void close() noexcept;

 private:
  struct NextIds {
    std::int64_t frame = 1, event = 1;
  };
  store::Statement& insert(Table table) { return *inserts_[static_cast<std::size_t>(table)]; }
  void put_frame(const LiveRecord& record);
  void put_event(const LiveRecord& record);

  std::optional<store::FileLock> lock_;
  std::optional<store::Database> database_;
  std::array<std::optional<store::Statement>, kTables> inserts_;
  std::optional<store::Transaction> transaction_;
  NextIds next_, before_batch_;
};

}  // namespace palpate::session
