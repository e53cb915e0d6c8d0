// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <palpate/recording/run_reader.hpp>
#include <palpate/session/live_record.hpp>
#include <palpate/session/writer.hpp>

namespace palpate::session {

/// True for a file that begins as SQLite files do.
bool looks_like_session(const std::filesystem::path& path);

/// What a frame must have for a reader to give it.
enum class Wanted : std::uint8_t {
  kWhole,   ///< itself, its readings and its estimate
  kFrames,  ///< itself and its readings; what became of its estimate says SessionReader::estimate_state
};

enum class EstimateState : std::uint8_t {
  kWhole,
  kChanged,  ///< there, but some number is not the one that was written
  kLost,     ///< LiveRecord::estimate is empty
};

/// A session read back, in the order in which it was recorded: frames with their estimates, and events at their place
/// between them (a stale one is an event "stale"). A frame of which anything that is wanted is not as it was written is
/// passed over and told in damage(); the rest is read. Nothing but the constructor throws. Reads a session that is
/// being written, as it was when the reader was made.
class SessionReader {
 public:
  /// Throws InputError where the file is no session, or of a later program.
  explicit SessionReader(const std::filesystem::path& path, Wanted wanted = Wanted::kWhole);
  ~SessionReader();
  SessionReader(SessionReader&&) noexcept;

  const std::vector<SessionCatheter>& catheters() const;
  /// Of table session: "program_version", "started", ...; empty where it is not there.
  std::string about(const std::string& key) const;
  /// False at the end. `record` is filled but for what is not stored of an Estimate (docs/reference/session.md).
  [[nodiscard]] bool next(LiveRecord& record);
  /// Of the frame that next() gave last.
  EstimateState estimate_state() const;
  /// One line each: what could not be read, with page, byte offset and rows; complete once next() has said false.
  const std::vector<std::string>& damage() const;
  /// Frames and events that are known to have been written and could not be read; likewise.
  std::int64_t lost() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace palpate::session
