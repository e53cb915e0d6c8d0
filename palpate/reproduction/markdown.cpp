// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <palpate/reproduction/markdown.hpp>

namespace palpate::reproduction {

namespace {

std::string line(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths, char fill) {
  std::string text = "|";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    text += fill + cells[i] + std::string(widths[i] - std::min(widths[i], cells[i].size()), fill) + fill + "|";
  }
  return text + "\n";
}

}  // namespace

std::string MarkdownTable::text() const {
  std::vector<std::size_t> widths;
  for (const std::string& cell : header) widths.push_back(std::max<std::size_t>(3, cell.size()));
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  std::string text = line(header, widths, ' ') + line(std::vector<std::string>(header.size()), widths, '-');
  for (const auto& row : rows) text += line(row, widths, ' ');
  return text;
}

std::string short_number(double value) {
  const double size = std::abs(value);
  return size == 0.0 || (size >= 1e-3 && size < 1e5) ? fmt::format("{:.3g}", value) : fmt::format("{:.2e}", value);
}

std::string picture(const std::string& name, const std::string& caption) {
  return fmt::format("![{}]({}.svg)\n", caption, name);
}

std::string against(double ours, double theirs) {
  const double ratio = std::abs(ours) / std::abs(theirs);
  return ratio <= 1.0 ? "below" : fmt::format("{:.2g} times", ratio);
}

}  // namespace palpate::reproduction
