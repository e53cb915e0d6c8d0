// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/catheter_tendon_map.hpp>
#include <palpate/recording/precurvature_csv.hpp>
#include <palpate/recording/text_table.hpp>

namespace palpate {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::array kInputs{TendonInput::kKnob, TendonInput::kDisplacement, TendonInput::kTension};

/// Column of the handle's position and what makes SI of it.
struct PositionColumn {
  TendonInput input;
  std::size_t column;
  double si_per_unit;
};

PositionColumn position_column(const CsvReader& csv, const std::string& file, std::optional<TendonInput> asked) {
  std::vector<PositionColumn> found;
  for (const TendonInput input : kInputs)
    if (const auto column = csv.find(name_of(input)); column && (!asked || *asked == input))
      found.push_back({input, *column, si_per_unit(input)});
  if (const auto column = csv.find("knob_deg"); column && (!asked || *asked == TendonInput::kKnob))
    found.push_back({TendonInput::kKnob, *column, kRadiansPerDegree});
  if (found.size() == 1) return found.front();
  throw InputError(fmt::format("{}:1: columns '{}': expected {}one of knob_rad, knob_deg, displacement_mm, tension_N{}",
                               file, printable(fmt::format("{}", fmt::join(csv.columns(), ","))),
                               found.empty() ? "" : "only ", found.empty() ? "" : ", or --input to choose"));
}

double sigma_at(const CsvReader& csv, std::optional<std::size_t> column) {
  if (!column || csv.text(*column).empty()) return 0.0;
  const double sigma = csv.finite_number(*column);
  if (sigma < 0.0) csv.refuse(*column, "a standard deviation, 0 or more");
  return sigma;
}

double curvature_at(const CsvReader& csv, std::size_t column) {
  const double k = csv.finite_number(column);
  if (std::abs(k) > 1000.0) csv.refuse(column, "a curvature in 1/m, at most 1000");
  return k;
}

/// As written; empty where blank.
std::optional<bool> release_at(const CsvReader& csv, std::optional<std::size_t> column) {
  if (!column || csv.text(*column).empty()) return std::nullopt;
  if (csv.text(*column) == "release") return true;
  if (csv.text(*column) != "pull") csv.refuse(*column, "pull or release");
  return false;
}

}  // namespace

std::optional<TendonInput> tendon_input(std::string_view name) {
  for (const TendonInput input : kInputs)
    if (name == name_of(input)) return input;
  return std::nullopt;
}

bool is_shaft_point_csv(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path) || path.extension() != ".csv") return false;
  const TextFile file = read_text_file(path);
  for (const std::string& line : file.lines) {
    if (trim(line).empty()) continue;
    const std::vector<std::string_view> columns = split(line, ',');
    return std::find(columns.begin(), columns.end(), "arc_length_mm") != columns.end();
  }
  return false;
}

std::vector<ShaftPointRow> read_shaft_point_csv(const std::filesystem::path& path, double length_m) {
  const TextFile file = read_text_file(path);
  CsvReader csv(file);
  const std::size_t arc = csv.require("arc_length_mm");
  const std::array columns{csv.find("x_mm"), csv.find("y_mm"), csv.find("z_mm")};
  if (std::count_if(columns.begin(), columns.end(), [](const auto& c) { return c.has_value(); }) < 2)
    refuse_field(file.name, 1, "header", printable(fmt::format("{}", fmt::join(csv.columns(), ","))),
                 "two or three of x_mm, y_mm, z_mm beside arc_length_mm");
  std::vector<ShaftPointRow> rows;
  while (csv.next()) {
    ShaftPointRow row{.arc_length_m = csv.finite_number(arc) * kMetresPerMillimetre, .position_m = {}};
    if (!(row.arc_length_m >= 0.0 && row.arc_length_m <= length_m * (1.0 + 1e-9)))
      csv.refuse(arc, fmt::format("mm from the clamp, 0..{:.6g}, the shaft of the catheter file with its tip",
                                  length_m * kMillimetresPerMetre));
    for (std::size_t axis = 0; axis < 3; ++axis)
      row.position_m(static_cast<Eigen::Index>(axis)) =
          columns[axis] ? csv.finite_number(*columns[axis]) * kMetresPerMillimetre : kNaN;
    rows.push_back(row);
  }
  if (rows.empty()) refuse_field(file.name, csv.line(), "row", "", "at least one row after the header");
  return rows;
}

std::vector<bool> releases_by_order(const std::vector<double>& position) {
  std::vector<bool> release(position.size(), false);
  bool falls = false;
  for (std::size_t i = 1; i < position.size(); ++i) {
    if (position[i] != position[i - 1]) falls = position[i] < position[i - 1];
    release[i] = falls;
  }
  if (position.size() > 1) release[0] = release[1];
  return release;
}

HandleTable read_handle_table_csv(const std::filesystem::path& path, std::optional<TendonInput> asked,
                                  double k2_otherwise_per_m) {
  const TextFile file = read_text_file(path);
  CsvReader csv(file);
  const PositionColumn position = position_column(csv, file.name, asked);
  const std::size_t k1 = csv.require("k1_per_m");
  const auto k2 = csv.find("k2_per_m"), sigma_1 = csv.find("sigma_k1_per_m"), sigma_2 = csv.find("sigma_k2_per_m"),
             direction = csv.find("direction");
  HandleTable table{.input = position.input, .has_k2 = k2.has_value(), .rows = {}};
  std::vector<std::optional<bool>> written;
  std::vector<double> positions;
  while (csv.next()) {
    HandleRow& row = table.rows.emplace_back();
    row.position = csv.finite_number(position.column) * position.si_per_unit;
    row.precurvature_per_m = {curvature_at(csv, k1), k2 ? curvature_at(csv, *k2) : k2_otherwise_per_m};
    row.sigma_per_m = {sigma_at(csv, sigma_1), sigma_at(csv, sigma_2)};
    positions.push_back(row.position);
    written.push_back(release_at(csv, direction));
  }
  const std::vector<bool> by_order = releases_by_order(positions);
  for (std::size_t i = 0; i < table.rows.size(); ++i) table.rows[i].release = written[i].value_or(by_order[i]);
  if (table.rows.empty()) refuse_field(file.name, csv.line(), "row", "", "at least one row after the header");
  return table;
}

}  // namespace palpate
