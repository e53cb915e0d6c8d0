// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace palpate::session {

/// Where a row of a table stands, or should, in a SQLite file: found by the way down the table's tree, read from the
/// raw file, for SQLite itself names no place where it fails. The page at which the way ends: the row's leaf, or the
/// first page that cannot be gone through. 0: not even the first page can be read.
struct PagePlace {
  std::int64_t page = 0;    ///< from 1
  std::int64_t offset = 0;  ///< of its first byte in the file
  bool beyond_end = false;  ///< the file ends before it
};
PagePlace find_page(const std::filesystem::path& file, std::int64_t root_page, std::int64_t row_id);

/// "page 12, byte 45056".
std::string describe(const PagePlace& place);

/// The same text with the byte at which it begins behind each page that it names.
std::string with_offsets(const std::string& text, std::int64_t page_bytes);

}  // namespace palpate::session
