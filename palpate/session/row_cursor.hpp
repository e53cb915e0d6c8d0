// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <palpate/session/schema.hpp>
#include <string>

namespace palpate::session {

/// Goes through one table by id, and on behind what cannot be read. Nothing of it throws.
class RowCursor {
 public:
  RowCursor(const store::Database& database, Table table);

  enum class At : std::uint8_t { kRow, kEnd, kDamage };

  /// To the first row whose id is at least `id`; cheap where that is here or a little further.
  At seek(std::int64_t id);
  /// To the next row in the file's order.
  At step();
  /// After kDamage: to the first row from `id` on that can be read.
  At recover(std::int64_t id);

  std::int64_t id() const { return id_; }               ///< at kRow
  const store::Statement& row() const { return row_; }  ///< likewise
  const std::string& error() const { return error_; }   ///< of the last kDamage

 private:
  At go_to(std::int64_t id);
  At take_step();

  store::Statement row_;
  At at_ = At::kDamage;
  std::int64_t id_ = 0;
  std::int64_t first_from_ = 0;  ///< no row stands between this id and the current one
  std::string error_;
};

}  // namespace palpate::session
