// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <palpate/session/open_session.hpp>
#include <palpate/session/schema.hpp>
#include <string>
#include <vector>

namespace palpate::session {

/// Gathers what could not be read, and says where that stands in the file.
class LostRows {
 public:
  explicit LostRows(const OpenSession& session) : session_(session) {}

  /// `what` ("frame", "event") from `first` to `last` by id, for want of rows of `table`. Calls in order of id: what
  /// touches what was said last, for the same reason, is one line with it.
  void add(std::string_view what, std::int64_t first, std::int64_t last, Table table, const std::string& why);
  /// Nothing can be read of `table` from here to its end.
  void add_tail(std::string_view what, std::int64_t first, Table table, const std::string& why);
  std::int64_t count() const { return count_; }
  /// One line each, and what SQLite's own check of the file says.
  std::vector<std::string> lines() const;

 private:
  struct Range {
    std::string_view what;
    std::int64_t first, last;  ///< last: -1: to the end
    Table table;
    std::string why;
  };
  std::string line(const Range& range) const;

  const OpenSession& session_;
  std::vector<Range> ranges_;
  std::int64_t count_ = 0;
};

/// What SQLite says about a file that is not whole, with byte offsets; empty where it is. `full`: also whether every
/// index agrees with its table. Reads the whole file.
std::vector<std::string> check_integrity(const store::Database& database, bool full);

}  // namespace palpate::session
