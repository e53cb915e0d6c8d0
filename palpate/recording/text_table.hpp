// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Text files as people and devices write them: lines with numbers, separated fields, strict numbers.
namespace palpate {

/// Throws InputError with one line: `FILE:LINE: field NAME: value 'VALUE': expected EXPECTATION`.
[[noreturn]] void refuse_field(std::string_view file, std::size_t line, std::string_view field, std::string_view value,
                               std::string_view expectation);

/// `text` fit for a message: control characters become '?', anything after `most` characters becomes "...".
std::string printable(std::string_view text, std::size_t most = 80);

/// A whole text file. A UTF-8 byte order mark and the CR of CRLF are gone.
struct TextFile {
  std::string name;                ///< the path as given
  std::vector<std::string> lines;  ///< line number = index + 1
  bool ends_with_newline = true;   ///< false: the last line may be cut
  bool stopped = false;            ///< a line starting with `last_line_prefix` was found; nothing after it was read
};

/// Reads `path`, at most up to the line that starts with `last_line_prefix` (where that is not empty).
/// Throws InputError where the file is missing, unreadable, a directory or empty.
TextFile read_text_file(const std::filesystem::path& path, std::string_view last_line_prefix = {});

/// Without spaces and tabs at both ends.
std::string_view trim(std::string_view text);

/// Trimmed fields between delimiters; n delimiters give n + 1 fields.
std::vector<std::string_view> split(std::string_view line, char delimiter);

/// Trimmed fields between runs of spaces and tabs; none of them is empty.
std::vector<std::string_view> split_blank(std::string_view line);

/// The whole of `text` as a number; nan and inf in any case are numbers. Empty where anything is left over.
std::optional<double> parse_number(std::string_view text);
std::optional<std::int64_t> parse_integer(std::string_view text);

/// Rows of a table whose first line that is not blank is the header. Blank lines are skipped. `file` must outlive it.
class CsvReader {
 public:
  /// Throws InputError where there is no header, or a column has no name or stands twice.
  explicit CsvReader(const TextFile& file, char delimiter = ',');

  const std::vector<std::string_view>& columns() const { return columns_; }
  std::optional<std::size_t> find(std::string_view column) const;
  /// Throws InputError where the header lacks `column`.
  std::size_t require(std::string_view column) const;

  /// Goes to the next row; false at the end. Throws InputError where the number of fields is not the header's.
  bool next();

  std::size_t line() const { return line_; }
  std::string_view text(std::size_t column) const { return fields_[column]; }
  /// The field as a number, NaN and infinities included. Throws InputError on anything else.
  double number(std::size_t column) const;
  double finite_number(std::size_t column) const;
  std::int64_t integer(std::size_t column) const;
  /// Throws InputError about this row's field.
  [[noreturn]] void refuse(std::size_t column, std::string_view expectation) const;

 private:
  void check_columns() const;
  void check_field_count() const;

  const TextFile& file_;
  char delimiter_;
  std::size_t line_ = 0;  ///< number of the line read last
  std::size_t header_line_ = 0;
  std::vector<std::string_view> columns_;
  std::vector<std::string_view> fields_;
};

}  // namespace palpate
