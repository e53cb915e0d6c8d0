// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <palpate/math/errors.hpp>
#include <palpate/session/open_session.hpp>
#include <palpate/session/reader.hpp>
#include <palpate/session/schema.hpp>

namespace palpate::session {

namespace {

using store::OpenMode;

std::filesystem::path log_of(const std::filesystem::path& path) { return path.string() + "-wal"; }

std::uintmax_t bytes_of(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  return error ? 0 : bytes;
}

/// A database in which no log has to be brought in, or whose log can be.
std::unique_ptr<store::Database> open_file(const std::filesystem::path& path, OpenMode mode) {
  auto database = std::make_unique<store::Database>(path, mode);
  database->integer("SELECT count(*) FROM session");
  return database;
}

/// In a folder that is read-only SQLite cannot go through the log: a copy of both is read instead.
void open_copy(OpenSession& session) {
  try {
    session.folder = std::make_unique<ScratchFolder>();
    const std::filesystem::path copy = session.folder->path() / "session";
    std::filesystem::copy_file(session.path, copy);
    std::filesystem::copy_file(log_of(session.path), log_of(copy));
    session.database = open_file(copy, OpenMode::kSalvage);
    session.main_file = copy;
  } catch (const std::exception& error) {
    session.database = open_file(session.path, OpenMode::kAsItLies);
    session.folder.reset();
    session.damage.push_back(fmt::format(
        "{}: {} bytes written last cannot be brought in, and are lost to this reading: {}; copy both files to a folder "
        "that can be written",
        log_of(session.path).string(), bytes_of(log_of(session.path)), error.what()));
  }
}

void check_head(const OpenSession& session) {
  const store::Database& database = *session.database;
  if (database.integer("PRAGMA application_id") != kApplication)
    throw InputError(
        fmt::format("{}: is a database of another program: expected a session of Palpate", session.path.string()));
  const std::int64_t version = database.integer("PRAGMA user_version");
  if (version < 1 || version > schema_version())
    throw InputError(fmt::format("{}: user_version = {}: expected 1 to {}; it was written by a later program",
                                 session.path.string(), version, schema_version()));
}

}  // namespace

bool looks_like_session(const std::filesystem::path& path) {
  constexpr std::string_view magic("SQLite format 3\0", 16);
  std::string start(magic.size(), ' ');
  std::ifstream stream(path, std::ios::binary);
  return stream.read(start.data(), static_cast<std::streamsize>(start.size())) && start == magic;
}

ScratchFolder::ScratchFolder() {
  static std::atomic<unsigned> counter{0};
  path_ = std::filesystem::temp_directory_path() / fmt::format("palpate-session-{}-{}", ::getpid(), counter++);
  std::filesystem::create_directories(path_);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

OpenSession open_session(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path))
    throw InputError(fmt::format("{}: cannot be read: expected a session's file", path.string()));
  if (!looks_like_session(path))
    throw InputError(fmt::format("{}: does not begin as SQLite files do: expected a session of palpate record or serve",
                                 path.string()));
  OpenSession session;
  session.path = session.main_file = path;
  try {
    session.database = open_file(path, OpenMode::kSalvage);
  } catch (const InputError&) {
    if (bytes_of(log_of(path)) > 0)
      open_copy(session);
    else
      session.database = open_file(path, OpenMode::kAsItLies);
  }
  check_head(session);
  return session;
}

}  // namespace palpate::session
