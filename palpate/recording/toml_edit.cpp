// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <palpate/math/errors.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/output_file.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/recording/toml_edit.hpp>
#include <palpate/recording/toml_table.hpp>

namespace palpate {
namespace {

toml::table parse_lines(const std::string& source, const std::vector<std::string>& lines) {
  return parse_toml({.name = source, .lines = lines});
}

/// Byte of the 1-based `column`, which counts code points.
std::size_t byte_of_column(std::string_view line, toml::source_index column) {
  std::size_t byte = 0;
  for (toml::source_index at = 1; byte < line.size() && at < column; ++at) {
    ++byte;
    while (byte < line.size() && (static_cast<unsigned char>(line[byte]) & 0xC0) == 0x80) ++byte;
  }
  return byte;
}

}  // namespace

/// Where a value stands, or the line below which it is to be added.
struct TomlEdit::Place {
  bool exists = false;
  std::size_t first_line = 0, last_line = 0;  ///< 0-based
  std::size_t from_byte = 0, end_byte = 0;    ///< in the first and in the last line
};

TomlEdit::TomlEdit(const std::filesystem::path& path) {
  const TextFile file = read_text_file(path);
  source_ = file.name;
  lines_ = file.lines;
  parse_lines(source_, lines_);
}

TomlEdit::Place TomlEdit::find(std::string_view table, std::size_t index, std::string_view key) const {
  const toml::table root = parse_lines(source_, lines_);
  const toml::node* node = root.at_path(table).node();
  if (node != nullptr && node->is_array()) node = node->as_array()->get(index);
  const toml::table* owner = node != nullptr ? node->as_table() : nullptr;
  if (owner == nullptr) throw InputError(fmt::format("{}: expected a table [{}]", source_, table));
  Place place;
  if (const toml::node* value = owner->get(key)) {
    const toml::source_region& at = value->source();
    place = {.exists = true, .first_line = at.begin.line - 1, .last_line = at.end.line - 1};
    place.from_byte = byte_of_column(lines_[place.first_line], at.begin.column);
    place.end_byte = byte_of_column(lines_[place.last_line], at.end.column);
    return place;
  }
  place.first_line = owner->source().begin.line - 1;
  if (!trim(lines_[place.first_line]).starts_with('['))
    throw InputError(fmt::format("{}:{}: expected the table {} under a header [{}] of its own, for {} is to be added",
                                 source_, place.first_line + 1, table, table, key));
  return place;
}

void TomlEdit::put(const Place& place, std::string_view key, std::string_view value, std::string_view comment) {
  if (!place.exists) {
    const auto below = lines_.begin() + static_cast<std::ptrdiff_t>(place.first_line + 1);
    lines_.insert(below, fmt::format("{} = {}{}{}", key, value, comment.empty() ? "" : "  # ", comment));
    return;
  }
  const std::string head = lines_[place.first_line].substr(0, place.from_byte);
  std::string tail = lines_[place.last_line].substr(place.end_byte);
  if (!comment.empty()) {
    const std::size_t behind = tail.find_first_not_of(" \t");
    const bool is_comment = behind == std::string::npos || tail[behind] == '#';  // not so inside an inline table
    if (is_comment) tail = fmt::format("  # {}", comment);
  }
  const auto first = lines_.begin() + static_cast<std::ptrdiff_t>(place.first_line);
  *first = fmt::format("{}{}{}", head, value, tail);
  lines_.erase(first + 1, lines_.begin() + static_cast<std::ptrdiff_t>(place.last_line + 1));
}

void TomlEdit::set(std::string_view table, std::string_view key, std::string_view value, std::string_view comment) {
  if (!parse_lines(source_, lines_).contains(table)) {
    lines_.emplace_back();
    lines_.push_back(fmt::format("[{}]", table));
  }
  put(find(table, 0, key), key, value, comment);
}

void TomlEdit::set(std::string_view table, std::size_t index, std::string_view key, std::string_view value,
                   std::string_view comment) {
  put(find(table, index, key), key, value, comment);
}

void TomlEdit::remove(std::string_view table, std::string_view key) {
  if (!parse_lines(source_, lines_).contains(table)) return;
  const toml::table root = parse_lines(source_, lines_);
  if (const toml::table* owner = root.get_as<toml::table>(table); owner == nullptr || !owner->contains(key)) return;
  remove(table, 0, key);
}

void TomlEdit::remove(std::string_view table, std::size_t index, std::string_view key) {
  const Place place = find(table, index, key);
  if (!place.exists) return;
  const std::string& first = lines_[place.first_line];
  const bool alone = trim(first).starts_with(key) && trim(first.substr(0, place.from_byte)).ends_with('=');
  if (!alone)
    throw InputError(fmt::format("{}:{}: expected {} of {} on a line of its own, for it is to be removed", source_,
                                 place.first_line + 1, key, table));
  const auto at = [&](std::size_t line) { return lines_.begin() + static_cast<std::ptrdiff_t>(line); };
  lines_.erase(at(place.first_line), at(place.last_line + 1));
}

bool TomlEdit::has(std::string_view table, std::size_t index, std::string_view key) const {
  const toml::table root = parse_lines(source_, lines_);
  const toml::node* node = root.get(table);
  if (node != nullptr && node->is_array()) node = node->as_array()->get(index);
  const toml::table* owner = node != nullptr ? node->as_table() : nullptr;
  return owner != nullptr && owner->contains(key);
}

std::vector<std::string> TomlEdit::names(std::string_view table) const {
  const toml::table root = parse_lines(source_, lines_);
  std::vector<std::string> found;
  const toml::array* tables = root.get_as<toml::array>(table);
  if (tables == nullptr) return found;
  for (const toml::node& entry : *tables)
    found.push_back(entry.is_table() ? (*entry.as_table())["name"].value_or(std::string()) : std::string());
  return found;
}

void TomlEdit::add_heading(std::string_view comment) { lines_.insert(lines_.begin(), fmt::format("# {}", comment)); }

std::string TomlEdit::text() const { return fmt::format("{}\n", fmt::join(lines_, "\n")); }

void write_catheter_file(const TomlEdit& edit, const std::filesystem::path& path, const std::function<void()>& before) {
  parse_catheter({.name = path.string(), .lines = edit.lines()});
  OutputFile file(path);
  file.write(edit.text());
  before();
  file.commit();
}

std::string toml_number(double value, int digits) {
  const std::string text = fmt::format("{:.{}g}", value, digits);
  const bool is_integer = text.find_first_of(".en") == std::string::npos;
  return is_integer ? text + ".0" : text;
}

std::string toml_array(const std::vector<double>& values, int digits) {
  std::vector<std::string> texts;
  texts.reserve(values.size());
  for (const double value : values) texts.push_back(toml_number(value, digits));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

}  // namespace palpate
