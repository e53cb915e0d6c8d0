// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <palpate/math/errors.hpp>
#include <palpate/recording/nearest_name.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/recording/toml_table.hpp>

namespace palpate {
namespace {

/// As TOML would write it, numbers with as few digits as say which they are.
std::string show(const toml::node* node) {
  if (node == nullptr) return "(absent)";
  if (const auto* text = node->as_string()) return fmt::format("\"{}\"", text->get());
  if (const auto* integer = node->as_integer()) return fmt::format("{}", integer->get());
  if (const auto* number = node->as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* flag = node->as_boolean()) return flag->get() ? "true" : "false";
  if (node->is_table()) return "{...}";
  if (!node->is_array()) return "(a date or time)";
  std::vector<std::string> elements;
  for (const toml::node& element : *node->as_array()) elements.push_back(show(&element));
  return fmt::format("[{}]", fmt::join(elements, ", "));
}

bool in_range(double value, const NumberRange& range) { return value >= range.least && value <= range.most; }

[[noreturn]] void refuse_line(const TextFile& file, std::size_t line, std::string_view expectation) {
  throw InputError(fmt::format("{}:{}: line '{}': expected TOML: {}", file.name, line,
                               printable(trim(file.lines[line - 1])), printable(expectation, 400)));
}

/// toml++ 3.3 has undefined behaviour where no key follows the bracket of a table header: it never sees one.
void refuse_headers_without_key(const TextFile& file) {
  constexpr std::string_view kKeyStart = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-\"'";
  for (std::size_t i = 0; i < file.lines.size(); ++i) {
    std::string_view text = trim(file.lines[i]);
    if (!text.starts_with('[')) continue;
    text = trim(text.substr(1));
    if (text.starts_with('[')) text = trim(text.substr(1));
    if (text.empty() || kKeyStart.find(text.front()) == std::string_view::npos)
      refuse_line(file, i + 1, "[NAME] or [[NAME]]");
  }
}

}  // namespace

toml::table parse_toml(const TextFile& file) {
  refuse_headers_without_key(file);
  const std::string text = fmt::format("{}\n", fmt::join(file.lines, "\n"));
  try {
    return toml::parse(text, file.name);
  } catch (const toml::parse_error& error) {
    const auto line = std::clamp<std::size_t>(error.source().begin.line, 1, file.lines.size());
    refuse_line(file, line, error.description());
  }
}

TomlTable::TomlTable(const toml::table& table, std::string path, std::string file,
                     std::initializer_list<std::string_view> known_keys)
    : table_(&table), path_(std::move(path)), file_(std::move(file)) {
  for (const auto& [key, node] : table) {
    if (std::find(known_keys.begin(), known_keys.end(), key.str()) != known_keys.end()) continue;
    refuse(key.str(), fmt::format("a known key; did you mean {}?", nearest_name(key.str(), known_keys)));
  }
}

double TomlTable::number(std::string_view key, const NumberRange& range) const {
  if (const auto value = optional_number(key, range)) return *value;
  refuse(key, range.expectation);
}

double TomlTable::number(std::string_view key, const NumberRange& range, double fallback) const {
  return optional_number(key, range).value_or(fallback);
}

std::optional<double> TomlTable::optional_number(std::string_view key, const NumberRange& range) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return std::nullopt;
  if (node->is_string()) refuse(key, fmt::format("{}, as a number without quotes", range.expectation));
  const auto value = node->is_number() ? node->value<double>() : std::nullopt;
  if (!value || !in_range(*value, range)) refuse(key, range.expectation);
  return value;
}

int TomlTable::integer(std::string_view key, const NumberRange& range, int fallback) const {
  const toml::node* node = table_->get(key);
  if (node == nullptr) return fallback;
  if (!node->is_integer() || !in_range(node->value<double>().value_or(std::nan("")), range)) {
    refuse(key, range.expectation);
  }
  return static_cast<int>(node->value<std::int64_t>().value_or(fallback));
}

void TomlTable::read_numbers(std::string_view key, const NumberRange& each, double* values, std::size_t count) const {
  const toml::array* array = table_->get_as<toml::array>(key);
  const bool good = array != nullptr && array->size() == count && take_numbers(*array, each, values);
  if (!good) refuse(key, fmt::format("[{} numbers], each {}", count, each.expectation));
}

bool TomlTable::take_numbers(const toml::array& array, const NumberRange& each, double* values) {
  for (std::size_t i = 0; i < array.size(); ++i) {
    const toml::node& node = *array.get(i);
    values[i] = node.is_number() ? node.value<double>().value_or(std::nan("")) : std::nan("");
    if (!in_range(values[i], each)) return false;
  }
  return true;
}

std::vector<double> TomlTable::numbers(std::string_view key, const NumberRange& each, std::size_t least,
                                       std::size_t most) const {
  const toml::array* array = table_->get_as<toml::array>(key);
  std::vector<double> values(array != nullptr ? array->size() : 0);
  if (values.size() < least || values.size() > most || !take_numbers(*array, each, values.data()))
    refuse(key, fmt::format("[{} to {} numbers], each {}", least, most, each.expectation));
  return values;
}

std::string TomlTable::text(std::string_view key) const {
  const auto* value = table_->get_as<std::string>(key);
  if (value == nullptr || value->get().empty()) refuse(key, "a text in quotes, not empty");
  return value->get();
}

std::string TomlTable::text(std::string_view key, std::string_view fallback) const {
  return has(key) ? text(key) : std::string(fallback);
}

std::vector<std::string> TomlTable::texts(std::string_view key) const {
  std::vector<std::string> values;
  if (!has(key)) return values;
  constexpr std::string_view kExpectation = "an array of texts, such as [\"a\", \"b\"]";
  const toml::array* array = table_->get_as<toml::array>(key);
  if (array == nullptr) refuse(key, kExpectation);
  for (const toml::node& node : *array) {
    const auto* value = node.as_string();
    if (value == nullptr || value->get().empty()) refuse(key, kExpectation);
    values.push_back(value->get());
  }
  return values;
}

bool TomlTable::flag(std::string_view key, bool fallback) const {
  if (!has(key)) return fallback;
  const auto* value = table_->get_as<bool>(key);
  if (value == nullptr) refuse(key, "true or false");
  return value->get();
}

bool TomlTable::is_text(std::string_view key, std::string_view text) const {
  const auto* value = table_->get_as<std::string>(key);
  return value != nullptr && value->get() == text;
}

void TomlTable::refuse_choice(std::string_view key, const std::vector<std::string_view>& names) const {
  refuse(key, fmt::format("one of '{}'", fmt::join(names, "', '")));
}

std::optional<TomlTable> TomlTable::table(std::string_view key,
                                          std::initializer_list<std::string_view> known_keys) const {
  if (!has(key)) return std::nullopt;
  const toml::table* found = table_->get_as<toml::table>(key);
  if (found == nullptr) refuse(key, fmt::format("a table [{}]", dotted(key)));
  return TomlTable(*found, dotted(key), file_, known_keys);
}

std::vector<TomlTable> TomlTable::tables(std::string_view key,
                                         std::initializer_list<std::string_view> known_keys) const {
  std::vector<TomlTable> found;
  if (!has(key)) return found;
  const toml::array* array = table_->get_as<toml::array>(key);
  const bool good = array != nullptr &&
                    std::all_of(array->begin(), array->end(), [](const toml::node& node) { return node.is_table(); });
  if (!good) refuse(key, fmt::format("tables [[{}]]", dotted(key)));
  for (const toml::node& node : *array) found.emplace_back(*node.as_table(), dotted(key), file_, known_keys);
  return found;
}

std::string TomlTable::dotted(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

std::string TomlTable::describe(std::string_view key) const {
  const toml::node* node = table_->get(key);
  const auto line = (node != nullptr ? node->source() : table_->source()).begin.line;
  return fmt::format("{}:{}: {} = {}", file_, std::max<std::uint32_t>(line, 1), printable(dotted(key)),
                     printable(show(node)));
}

void TomlTable::refuse(std::string_view key, std::string_view expectation) const {
  throw InputError(fmt::format("{}: expected {}", describe(key), expectation));
}

}  // namespace palpate
