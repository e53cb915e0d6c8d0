// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sqlite3.h>

#include <filesystem>
#include <palpate/session/reader.hpp>
#include <string>
#include <vector>

namespace palpate::serve_test {

/// What a recording holds.
struct Session {
  std::vector<session::LiveRecord> frames;
  std::vector<std::string> events, damage;
};

inline Session read(const std::filesystem::path& path) {
  Session out;
  session::SessionReader reader(path);
  session::LiveRecord record;
  while (reader.next(record)) {
    if (record.kind == session::LiveRecord::Kind::kFrame)
      out.frames.push_back(record);
    else
      out.events.push_back(record.event);
  }
  out.damage = reader.damage();
  return out;
}

/// Another program at the same file, by SQLite alone.
class Connection {
 public:
  explicit Connection(const std::filesystem::path& path) { sqlite3_open(path.c_str(), &database_); }
  ~Connection() { sqlite3_close(database_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  /// First field of the first row; "done" without one, else what SQLite says.
  std::string ask(const char* sql) const {
    std::string answer = "done";
    const auto take = [](void* to, int, char** fields, char**) {
      *static_cast<std::string*>(to) = fields[0] == nullptr ? "NULL" : fields[0];
      return 0;
    };
    char* error = nullptr;
    if (sqlite3_exec(database_, sql, take, &answer, &error) != SQLITE_OK) answer = error == nullptr ? "error" : error;
    sqlite3_free(error);
    return answer;
  }

 private:
  sqlite3* database_ = nullptr;
};

}  // namespace palpate::serve_test
