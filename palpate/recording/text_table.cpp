// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <palpate/math/errors.hpp>
#include <palpate/recording/text_table.hpp>
#include <system_error>

namespace palpate {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kBlanks = " \t";

template <typename Number>
std::optional<Number> parse_whole(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::ifstream open_text(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputError(fmt::format("{}: is a directory: expected a text file", path.string()));
  }
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    throw InputError(fmt::format("{}: cannot be opened: {}: expected a readable text file", path.string(),
                                 std::strerror(errno != 0 ? errno : ENOENT)));
  }
  return stream;
}

}  // namespace

std::string printable(std::string_view text, std::size_t most) {
  std::string shown(text.substr(0, most));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  return text.size() > most ? shown + "..." : shown;
}

void refuse_field(std::string_view file, std::size_t line, std::string_view field, std::string_view value,
                  std::string_view expectation) {
  throw InputError(fmt::format("{}:{}: field {}: value '{}': expected {}", file, line, printable(field),
                               printable(value), expectation));
}

TextFile read_text_file(const std::filesystem::path& path, std::string_view last_line_prefix) {
  std::ifstream stream = open_text(path);
  TextFile file;
  file.name = path.string();
  std::string line;
  while (!file.stopped && std::getline(stream, line)) {
    file.ends_with_newline = !stream.eof();
    if (file.lines.empty() && line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
    if (line.ends_with('\r')) line.pop_back();
    file.stopped = !last_line_prefix.empty() && line.starts_with(last_line_prefix);
    file.lines.push_back(line);
  }
  if (stream.bad()) throw InputError(fmt::format("{}: cannot be read: {}", file.name, std::strerror(errno)));
  const bool empty =
      std::all_of(file.lines.begin(), file.lines.end(), [](const std::string& text) { return trim(text).empty(); });
  if (empty) throw InputError(fmt::format("{}: is empty: expected lines of text", file.name));
  return file;
}

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::vector<std::string_view> split(std::string_view line, char delimiter) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t end = line.find(delimiter);
    fields.push_back(trim(line.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
  }
}

std::vector<std::string_view> split_blank(std::string_view line) {
  std::vector<std::string_view> fields;
  for (line = trim(line); !line.empty(); line = trim(line)) {
    const std::size_t end = std::min(line.find_first_of(kBlanks), line.size());
    fields.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return fields;
}

std::optional<double> parse_number(std::string_view text) { return parse_whole<double>(text); }

std::optional<std::int64_t> parse_integer(std::string_view text) { return parse_whole<std::int64_t>(text); }

CsvReader::CsvReader(const TextFile& file, char delimiter) : file_(file), delimiter_(delimiter) {
  while (columns_.empty() && line_ < file_.lines.size()) {
    const std::string& text = file_.lines[line_++];
    if (!trim(text).empty()) columns_ = split(text, delimiter_);
  }
  header_line_ = line_;
  check_columns();
}

void CsvReader::check_columns() const {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (columns_[i].empty()) {
      refuse_field(file_.name, header_line_, "header", file_.lines[header_line_ - 1],
                   fmt::format("a name for column {}", i + 1));
    }
    if (std::find(columns_.begin(), columns_.begin() + static_cast<std::ptrdiff_t>(i), columns_[i]) !=
        columns_.begin() + static_cast<std::ptrdiff_t>(i)) {
      refuse_field(file_.name, header_line_, "header", columns_[i], "each column once");
    }
  }
}

std::optional<std::size_t> CsvReader::find(std::string_view column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  if (found == columns_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns_.begin());
}

std::size_t CsvReader::require(std::string_view column) const {
  if (const auto found = find(column)) return *found;
  refuse_field(file_.name, header_line_, "header", file_.lines[header_line_ - 1],
               fmt::format("a column named {}", column));
}

bool CsvReader::next() {
  while (line_ < file_.lines.size()) {
    const std::string& text = file_.lines[line_++];
    if (trim(text).empty()) continue;
    fields_ = split(text, delimiter_);
    check_field_count();
    return true;
  }
  return false;
}

void CsvReader::check_field_count() const {
  if (fields_.size() == columns_.size()) return;
  const bool cut = fields_.size() < columns_.size() && line_ == file_.lines.size() && !file_.ends_with_newline;
  refuse_field(
      file_.name, line_, "row", file_.lines[line_ - 1],
      fmt::format("{} fields, found {}{}", columns_.size(), fields_.size(), cut ? " (truncated last row)" : ""));
}

double CsvReader::number(std::size_t column) const {
  if (const auto value = parse_number(fields_[column])) return *value;
  refuse(column, "a number");
}

double CsvReader::finite_number(std::size_t column) const {
  const double value = number(column);
  if (!std::isfinite(value)) refuse(column, "a finite number");
  return value;
}

std::int64_t CsvReader::integer(std::size_t column) const {
  if (const auto value = parse_integer(fields_[column])) return *value;
  refuse(column, "an integer");
}

void CsvReader::refuse(std::size_t column, std::string_view expectation) const {
  refuse_field(file_.name, line_, columns_[column], fields_[column], expectation);
}

}  // namespace palpate
