// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <palpate/math/rotation.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::python {

inline std::string spelled(double value) {
  const std::string text = fmt::format("{}", value);
  return text.find_first_of(".en") == std::string::npos ? fmt::format("{}.0", text) : text;
}

inline std::string in_quotes(std::string_view text) {
  std::string inside;
  for (const char c : text) {
    if (c == '"' || c == '\\')
      inside += fmt::format("\\{}", c);
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      inside += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      inside += c;
  }
  return fmt::format("\"{}\"", inside);
}

/// Tables of a TOML file, in the order in which they are written. A reader multiplies a number by its `unit`: what came
/// of such a product comes back to the last bit, whatever else to that or the next.
class TomlText {
 public:
  void table(std::string_view name) { out_ += fmt::format("\n[{}]\n", name); }
  void entry(std::string_view name) { out_ += fmt::format("\n[[{}]]\n", name); }
  void raw(std::string_view key, std::string_view value) { out_ += fmt::format("{} = {}\n", key, value); }
  void text(std::string_view key, std::string_view value) { raw(key, in_quotes(value)); }
  void number(std::string_view key, double value, double unit = 1.0) { raw(key, spelled(value / unit)); }
  /// Left out where it is what the reader takes anyway.
  void number_unless(double usual, std::string_view key, double value, double unit = 1.0) {
    if (value != usual) number(key, value, unit);
  }
  template <class Numbers>
  void numbers(std::string_view key, const Numbers& values, double unit = 1.0) {
    std::vector<std::string> list;
    for (const double value : values) list.push_back(spelled(value / unit));
    raw(key, fmt::format("[{}]", fmt::join(list, ", ")));
  }
  void texts(std::string_view key, const std::vector<std::string>& values) {
    std::vector<std::string> list;
    for (const std::string& value : values) list.push_back(in_quotes(value));
    raw(key, fmt::format("[{}]", fmt::join(list, ", ")));
  }
  /// Scalar first, as it is read: normalised.
  void rotation(std::string_view key, const Matrix3d& R) {
    Eigen::Quaterniond q(R);
    q.normalize();
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    numbers(key, Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()));
  }
  std::string take() { return std::move(out_); }

 private:
  std::string out_ = "schema = 1\n";
};

}  // namespace palpate::python
