// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include <Eigen/Core>
#include <initializer_list>
#include <optional>
#include <palpate/recording/text_table.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate {

/// Throws InputError `FILE:LINE: line 'TEXT': expected TOML: ...`.
toml::table parse_toml(const TextFile& file);

/// What a number may be; `expectation` completes "expected ..." and names the unit.
struct NumberRange {
  double least;
  double most;
  std::string_view expectation;
};

/// One table of a TOML file, read by keys that are known beforehand. Everything it refuses is an InputError
/// `FILE:LINE: TABLE.KEY = VALUE: expected ...`. The toml::table must outlive it.
class TomlTable {
 public:
  /// `path` is the dotted name for messages, empty for the root. Throws on a key that is not in `known_keys`, with the
  /// nearest known one.
  TomlTable(const toml::table& table, std::string path, std::string file,
            std::initializer_list<std::string_view> known_keys);

  bool has(std::string_view key) const { return table_->contains(key); }
  const toml::node* find(std::string_view key) const { return table_->get(key); }  ///< null where absent
  const std::string& file() const { return file_; }
  std::string dotted(std::string_view key) const;  ///< the key's full name, as messages say it

  double number(std::string_view key, const NumberRange& range) const;
  double number(std::string_view key, const NumberRange& range, double fallback) const;
  std::optional<double> optional_number(std::string_view key, const NumberRange& range) const;
  int integer(std::string_view key, const NumberRange& range, int fallback) const;

  template <int Size>
  std::optional<Eigen::Matrix<double, Size, 1>> optional_vector(std::string_view key, const NumberRange& each) const {
    if (!has(key)) return std::nullopt;
    Eigen::Matrix<double, Size, 1> values;
    read_numbers(key, each, values.data(), Size);
    return values;
  }

  /// An array of `least` to `most` numbers.
  std::vector<double> numbers(std::string_view key, const NumberRange& each, std::size_t least, std::size_t most) const;

  std::string text(std::string_view key) const;
  std::string text(std::string_view key, std::string_view fallback) const;
  std::vector<std::string> texts(std::string_view key) const;
  bool flag(std::string_view key, bool fallback) const;

  template <typename Value>
  Value choice(std::string_view key, std::initializer_list<std::pair<std::string_view, Value>> choices,
               Value fallback) const {
    if (!has(key)) return fallback;
    std::vector<std::string_view> names;
    for (const auto& [name, value] : choices) {
      if (is_text(key, name)) return value;
      names.push_back(name);
    }
    refuse_choice(key, names);
  }

  std::optional<TomlTable> table(std::string_view key, std::initializer_list<std::string_view> known_keys) const;
  /// Array of tables; empty where absent.
  std::vector<TomlTable> tables(std::string_view key, std::initializer_list<std::string_view> known_keys) const;

  /// `FILE:LINE: TABLE.KEY = VALUE`; an absent key stands at the line of its table.
  std::string describe(std::string_view key) const;
  [[noreturn]] void refuse(std::string_view key, std::string_view expectation) const;

 private:
  static bool take_numbers(const toml::array& array, const NumberRange& each, double* values);
  void read_numbers(std::string_view key, const NumberRange& each, double* values, std::size_t count) const;
  bool is_text(std::string_view key, std::string_view text) const;
  [[noreturn]] void refuse_choice(std::string_view key, const std::vector<std::string_view>& names) const;

  const toml::table* table_;
  std::string path_;
  std::string file_;
};

}  // namespace palpate
