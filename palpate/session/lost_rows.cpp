// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/math/errors.hpp>
#include <palpate/session/lost_rows.hpp>
#include <palpate/session/page_search.hpp>

namespace palpate::session {

namespace {

constexpr std::size_t kMostRanges = 200;  // of a file that is damaged all over, the first so many are told

std::int64_t root_page(const store::Database& database, Table table) {
  try {
    store::Statement row = database.prepare("SELECT rootpage FROM sqlite_schema WHERE type = 'table' AND name = ?");
    return row.bind(1, table_name(table)).step() ? row.integer(0) : 0;
  } catch (const InputError&) {
    return 0;
  }
}

}  // namespace

void LostRows::add(std::string_view what, std::int64_t first, std::int64_t last, Table table, const std::string& why) {
  count_ += last - first + 1;
  if (!ranges_.empty()) {
    Range& before = ranges_.back();
    if (before.what == what && before.table == table && before.why == why && before.last + 1 == first) {
      before.last = last;
      return;
    }
  }
  if (ranges_.size() < kMostRanges) ranges_.push_back({what, first, last, table, why});
}

void LostRows::add_tail(std::string_view what, std::int64_t first, Table table, const std::string& why) {
  if (ranges_.size() < kMostRanges) ranges_.push_back({what, first, -1, table, why});
}

std::string LostRows::line(const Range& range) const {
  const std::string rows =
      range.last < 0 ? fmt::format("{}s from id {} on, how many is not known", range.what, range.first)
      : range.first == range.last
          ? fmt::format("{} id {}", range.what, range.first)
          : fmt::format("{}s id {} to {} ({})", range.what, range.first, range.last, range.last - range.first + 1);
  const std::int64_t row_id = range.table == Table::kReading ? kReadingsPerFrame * range.first : range.first;
  const std::int64_t root = root_page(*session_.database, range.table);
  const PagePlace place = root > 0 ? find_page(session_.main_file, root, row_id) : PagePlace{};
  return fmt::format("{}: {}: {}: table {}, {}", session_.path.string(), rows, range.why, table_name(range.table),
                     describe(place));
}

std::vector<std::string> LostRows::lines() const {
  std::vector<std::string> all = session_.damage;
  for (const Range& range : ranges_) all.push_back(line(range));
  if (ranges_.size() == kMostRanges)
    all.push_back(fmt::format("{}: more damage than is told here", session_.path.string()));
  if (ranges_.empty()) return all;
  for (const std::string& said : check_integrity(*session_.database, false))
    all.push_back(fmt::format("{}: {}", session_.path.string(), said));
  return all;
}

std::vector<std::string> check_integrity(const store::Database& database, bool full) {
  std::vector<std::string> said;
  try {
    const std::int64_t page_bytes = database.integer("PRAGMA page_size");
    store::Statement row = database.prepare(full ? "PRAGMA integrity_check(20)" : "PRAGMA quick_check(20)");
    while (row.step()) {
      std::string text = row.text(0);
      for (char& c : text) c = c == '\n' ? ' ' : c;
      if (text != "ok") said.push_back("integrity check: " + with_offsets(text, page_bytes));
    }
  } catch (const InputError& error) {
    said.push_back(fmt::format("integrity check: {}", error.what()));
  }
  return said;
}

}  // namespace palpate::session
