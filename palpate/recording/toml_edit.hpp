// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// A TOML file with some of its values replaced. All else stays to the letter: order, comments, layout.
class TomlEdit {
 public:
  /// Throws InputError where the file cannot be read or is no TOML.
  explicit TomlEdit(const std::filesystem::path& path);

  /// Puts `value`, as TOML spells it, for `key` of [table]. An absent key is added below the header of its table, an
  /// absent table at the end of the file. `comment` (one line; may be empty) replaces the one behind the value.
  void set(std::string_view table, std::string_view key, std::string_view value, std::string_view comment = {});
  /// The same in the `index`-th [[table]], which must be there.
  void set(std::string_view table, std::size_t index, std::string_view key, std::string_view value,
           std::string_view comment = {});
  /// Takes `key` out of [table]; nothing where it is absent.
  void remove(std::string_view table, std::string_view key);
  /// The same in the `index`-th [[table]].
  void remove(std::string_view table, std::size_t index, std::string_view key);
  /// True where the `index`-th [[table]], or [table] (index 0), has this key.
  bool has(std::string_view table, std::size_t index, std::string_view key) const;
  /// `name` of every [[table]], in the order of the file; empty where it has none.
  std::vector<std::string> names(std::string_view table) const;
  /// A comment line on top of the file.
  void add_heading(std::string_view comment);

  const std::string& source() const { return source_; }
  const std::vector<std::string>& lines() const { return lines_; }
  std::string text() const;

 private:
  struct Place;
  Place find(std::string_view table, std::size_t index, std::string_view key) const;
  void put(const Place& place, std::string_view key, std::string_view value, std::string_view comment);

  std::string source_;  ///< the path as given
  std::vector<std::string> lines_;
};

/// Writes the edited text as a catheter file: read back and checked before it is put in place, so what cannot be used
/// never stays. `before`: what is to be written first, once this file is sure to be. Throws InputError.
void write_catheter_file(
    const TomlEdit& edit, const std::filesystem::path& path, const std::function<void()>& before = [] {});

/// Numbers as TOML spells them, rounded to `digits` significant ones: "[0.2612e-3, ...]" as "[0.0002612, ...]".
std::string toml_number(double value, int digits = 6);
std::string toml_array(const std::vector<double>& values, int digits = 6);

}  // namespace palpate
