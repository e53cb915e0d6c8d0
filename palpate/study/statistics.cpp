// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/study/plan.hpp>
#include <palpate/study/statistics.hpp>

namespace palpate::study {

namespace {

constexpr std::size_t kTenths = 10;

double quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], at - static_cast<double>(below));
}

std::string spell(const nlohmann::json& value) {
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// As spell() of the value that was stored.
std::string spell(const store::Statement& row, int column) {
  if (row.is_text(column)) return row.text(column);
  return row.is_integer(column) ? fmt::format("{}", row.integer(column)) : fmt::format("{}", row.number(column));
}

Parameter range_of(const nlohmann::json& p) {
  return {.name = {},
          .values = {},
          .from = p.at("range").at(0).get<double>(),
          .to = p.at("range").at(1).get<double>(),
          .logarithmic = p.at("logarithmic").get<bool>()};
}

std::size_t tenth(const Parameter& p, double value) {
  const auto scaled = [&p](double x) { return p.logarithmic ? std::log(x) : x; };
  const double share = (scaled(value) - scaled(p.from)) / (scaled(p.to) - scaled(p.from));
  return static_cast<std::size_t>(
      std::clamp(share * static_cast<double>(kTenths), 0.0, static_cast<double>(kTenths - 1)));
}

}  // namespace

Spread spread_of(std::vector<double> values) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (values.empty()) return {.runs = 0, .mean = kNone, .low = kNone, .median = kNone, .high = kNone};
  std::sort(values.begin(), values.end());
  Spread spread{.runs = values.size()};
  for (const double value : values) spread.mean += value / static_cast<double>(values.size());
  spread.low = quantile(values, 0.05);
  spread.median = quantile(values, 0.5);
  spread.high = quantile(values, 0.95);
  return spread;
}

Groups groups_of(const nlohmann::json& parameter) {
  Groups groups{.parameter = parameter.at("name").get<std::string>(), .labels = {}, .x = {}};
  if (parameter.contains("range")) {
    const Parameter range = range_of(parameter);
    groups.numeric = true;
    groups.logarithmic = range.logarithmic;
    for (std::size_t i = 0; i < kTenths; ++i) {
      const double share = static_cast<double>(i) / kTenths;
      groups.labels.push_back(fmt::format("{:.4g} .. {:.4g}", between(range, share), between(range, share + 0.1)));
      groups.x.push_back(between(range, share + 0.05));
    }
    return groups;
  }
  const nlohmann::json& values = parameter.at("values");
  groups.numeric = std::all_of(values.begin(), values.end(), [](const auto& v) { return v.is_number(); });
  for (const nlohmann::json& value : values) {
    groups.labels.push_back(spell(value));
    groups.x.push_back(groups.numeric ? value.get<double>() : static_cast<double>(groups.labels.size()));
  }
  return groups;
}

std::vector<Spread> spreads_by(const store::Database& database, const nlohmann::json& parameter,
                               const std::string& column) {
  const Groups groups = groups_of(parameter);
  std::vector<std::vector<double>> values(groups.labels.size());
  store::Statement row =
      database.prepare(fmt::format("SELECT {0}, {1} FROM run WHERE failure IS NULL AND {1} IS NOT NULL",
                                   store::quoted(groups.parameter), store::quoted(column)));
  while (row.step()) {
    const auto group =
        parameter.contains("range")
            ? tenth(range_of(parameter), row.number(0))
            : static_cast<std::size_t>(std::find(groups.labels.begin(), groups.labels.end(), spell(row, 0)) -
                                       groups.labels.begin());
    if (group < values.size()) values[group].push_back(row.number(1));
  }
  std::vector<Spread> spreads;
  spreads.reserve(values.size());
  for (std::vector<double>& group : values) spreads.push_back(spread_of(std::move(group)));
  return spreads;
}

Spread spread_over_all(const store::Database& database, const std::string& column) {
  std::vector<double> values;
  store::Statement row = database.prepare(
      fmt::format("SELECT {0} FROM run WHERE failure IS NULL AND {0} IS NOT NULL", store::quoted(column)));
  while (row.step()) values.push_back(row.number(0));
  return spread_of(std::move(values));
}

}  // namespace palpate::study
