// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <palpate/session/live_record.hpp>
#include <string>
#include <vector>

namespace palpate::session {

/// One catheter of a session, as it was at the start.
struct SessionCatheter {
  std::string name;
  std::string file;                       ///< path of its catheter file, for messages
  std::string toml;                       ///< and the text of it: catheter and settings of the estimator
  std::vector<std::string> sensor_names;  ///< order of the readings: as Catheter::sensors, a tracked base last
};

enum class Durability : std::uint8_t {
  kNormal,  ///< a power cut may take the last batch with it; killing the program takes nothing that was acknowledged
  kFull,    ///< nor does a power cut; some 4 ms a batch
};

struct WriterOptions {
  Durability durability = Durability::kNormal;
  double batch_s = 0.1;              ///< records are written together this often; range [0.01, 10]
  std::size_t queue = 8192;          ///< records that may wait; range [64, 1048576]. More are dropped, and counted
  std::string program_version = {};  ///< kept in the file
};

/// What became of the records, as any thread may ask. What the writer itself adds (events "dropped") is not counted.
struct WriterHealth {
  std::uint64_t offered = 0;           ///< taken into the queue
  std::uint64_t dropped = 0;           ///< refused: the queue was full
  std::uint64_t committed = 0;         ///< are in the file, for good (Durability)
  std::uint64_t committed_frames = 0;  ///< of them frames: rows of table frame
  bool failing = false;  ///< the last attempt to write failed, or lasts for 0.8 s already; it is tried again and again
  std::string error = {};  ///< why, in the words of the store; empty where nothing failed
};

/// Records a session into one SQLite file (docs/reference/session.md), from a thread of its own. The thread that offers
/// records never waits, never allocates in the long run, and never fails.
class SessionWriter {
 public:
  /// Throws InputError where the file exists, cannot be made, or is being written by another process.
  SessionWriter(const std::filesystem::path& path, const std::vector<SessionCatheter>& catheters,
                const WriterOptions& options);
  /// As close().
  ~SessionWriter();
  SessionWriter(const SessionWriter&) = delete;
  SessionWriter& operator=(const SessionWriter&) = delete;

  /// From one thread alone. False: the queue is full, the record is dropped and counted; where it is missing, an event
  /// "dropped" {"count", "from_ns", "to_ns"} stands in the file.
  bool offer(const LiveRecord& record) noexcept;

  WriterHealth health() const;

  /// Writes what is waiting, for two seconds at most where the disk does not let it, and lets go of the file. What
  /// became of the records in the end: committed < offered where some were lost. offer() must not be called after it.
  WriterHealth close() noexcept;

 private:
  class Work;
  std::shared_ptr<Work> work_;  ///< shared with its thread, which may be held by a disk that never answers
};

}  // namespace palpate::session
