// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <palpate/math/errors.hpp>
#include <palpate/session/row_cursor.hpp>

namespace palpate::session {

namespace {

constexpr std::int64_t kMostSteps = 64;                    // a seek costs more than some steps, and less than many
constexpr std::int64_t kFarthest = std::int64_t{1} << 48;  // no session has so many rows

}  // namespace

RowCursor::RowCursor(const store::Database& database, Table table) : row_(database.prepare(select_sql(table))) {}

RowCursor::At RowCursor::take_step() {
  try {
    at_ = row_.step() ? At::kRow : At::kEnd;
    if (at_ == At::kRow) id_ = row_.integer(0);
  } catch (const InputError& error) {
    error_ = error.what();
    at_ = At::kDamage;
  }
  if (at_ != At::kRow) row_.abandon();
  return at_;
}

RowCursor::At RowCursor::go_to(std::int64_t id) {
  row_.abandon();
  try {
    row_.bind(1, id).bind(2, std::numeric_limits<std::int64_t>::max());
  } catch (const InputError& error) {
    error_ = error.what();
    return at_ = At::kDamage;
  }
  first_from_ = id;
  return take_step();
}

RowCursor::At RowCursor::step() {
  if (at_ != At::kRow) return at_;
  first_from_ = id_ + 1;
  return take_step();
}

RowCursor::At RowCursor::seek(std::int64_t id) {
  if (at_ == At::kDamage || id < first_from_) return go_to(id);
  if (at_ == At::kEnd) return at_;
  if (id - id_ > kMostSteps) return go_to(id);
  while (at_ == At::kRow && id_ < id) step();
  return at_;
}

/// Doubles the distance until something can be read, then halves it: what cannot be read is whole pages of rows.
RowCursor::At RowCursor::recover(std::int64_t id) {
  std::int64_t bad = id - 1, good = 0;
  for (std::int64_t distance = 1; good == 0; distance *= 2) {
    if (id + distance > kFarthest) return at_ = At::kEnd;
    if (go_to(id + distance - 1) == At::kDamage)
      bad = id + distance - 1;
    else
      good = id + distance - 1;
  }
  while (good - bad > 1) {
    const std::int64_t middle = bad + (good - bad) / 2;
    (go_to(middle) == At::kDamage ? bad : good) = middle;
  }
  return go_to(good);
}

}  // namespace palpate::session
