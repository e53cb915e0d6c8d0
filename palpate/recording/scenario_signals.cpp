// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <palpate/math/units.hpp>
#include <palpate/recording/scenario_signals.hpp>

namespace palpate {
namespace {

constexpr NumberRange kFrequency_hz = {0.0, 1000.0, "a frequency in Hz, 0..1000"};
constexpr NumberRange kPhase_deg = {-1e6, 1e6, "an angle in degrees"};
constexpr double kMost_s = 1e6;

std::vector<Signal::Sine> read_sines(const TomlTable& table, const SignalUnit& unit) {
  const NumberRange amplitude = {-unit.range.most, unit.range.most, unit.range.expectation};
  std::vector<Signal::Sine> sines;
  for (const TomlTable& entry : table.tables("sines", {"amplitude", "frequency_hz", "phase_deg"}))
    sines.push_back({.amplitude = entry.number("amplitude", amplitude) * unit.si_per_unit,
                     .frequency_hz = entry.number("frequency_hz", kFrequency_hz),
                     .phase_rad = entry.number("phase_deg", kPhase_deg, 0.0) * kRadiansPerDegree});
  return sines;
}

/// [time, value], or none.
std::optional<std::pair<double, double>> as_point(const toml::node& node) {
  const toml::array* pair = node.as_array();
  if (pair == nullptr || pair->size() != 2) return std::nullopt;
  for (const toml::node& number : *pair)
    if (!number.is_number()) return std::nullopt;
  return std::pair{pair->get(0)->value<double>().value_or(std::nan("")),
                   pair->get(1)->value<double>().value_or(std::nan(""))};
}

std::vector<std::pair<double, double>> read_points(const TomlTable& table, const SignalUnit& unit) {
  std::vector<std::pair<double, double>> points;
  const toml::node* node = table.find("points");
  if (node == nullptr) return points;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->empty()) table.refuse("points", "[[time_s, value], ...]");
  for (const toml::node& element : *array) {
    const auto point = as_point(element);
    const auto refuse = [&](const std::string& expectation) {
      table.refuse("points", fmt::format("{}, at point {}", expectation, points.size() + 1));
    };
    if (!point || !(std::abs(point->first) <= kMost_s)) refuse("[time_s, value], two numbers");
    const auto [time_s, value] = *point;
    if (!points.empty() && !(time_s > points.back().first))
      refuse(fmt::format("times that rise, here {} s after {} s", time_s, points.back().first));
    if (!(value >= unit.range.least && value <= unit.range.most)) refuse(std::string(unit.range.expectation));
    points.emplace_back(time_s, value * unit.si_per_unit);
  }
  return points;
}

Signal read_signal_table(const TomlTable& table, const SignalUnit& unit) {
  if (!table.has("constant") && !table.has("sines") && !table.has("points"))
    table.refuse("constant", "constant, sines or points, at least one of them");
  if (table.has("course") && !table.has("points")) table.refuse("course", "this key only together with points");
  const NumberRange constant = {std::min(0.0, unit.range.least), unit.range.most, unit.range.expectation};
  return {
      .constant = table.number("constant", constant, 0.0) * unit.si_per_unit,
      .sines = read_sines(table, unit),
      .points = read_points(table, unit),
      .course = table.choice<Signal::Course>(
          "course",
          {{"linear", Signal::Course::kLinear}, {"hold", Signal::Course::kHold}, {"smooth", Signal::Course::kSmooth}},
          Signal::Course::kLinear)};
}

/// `key` is what `table` has to refuse; `name` is the dotted name of the node, which may lie deeper.
Signal read_node(const TomlTable& table, std::string_view key, const toml::node& node, const std::string& name,
                 const SignalUnit& unit) {
  if (const toml::table* inner = node.as_table())
    return read_signal_table(TomlTable(*inner, name, table.file(), {"constant", "sines", "points", "course"}), unit);
  const double value = node.is_number() ? node.value<double>().value_or(std::nan("")) : std::nan("");
  if (!(value >= unit.range.least && value <= unit.range.most))
    table.refuse(key, fmt::format("{}, or a table {{constant, sines, points, course}}", unit.range.expectation));
  return {.constant = value * unit.si_per_unit};
}

}  // namespace

Signal read_signal(const TomlTable& table, std::string_view key, const SignalUnit& unit) {
  const toml::node* node = table.find(key);
  if (node == nullptr)
    table.refuse(key, fmt::format("{}, or a table {{constant, sines, points, course}}", unit.range.expectation));
  return read_node(table, key, *node, table.dotted(key), unit);
}

Signal read_signal(const TomlTable& table, std::string_view key, const SignalUnit& unit, const Signal& fallback) {
  return table.has(key) ? read_signal(table, key, unit) : fallback;
}

Signal3 read_signals(const TomlTable& table, std::string_view key, const SignalUnit& unit) {
  const toml::node* node = table.find(key);
  const toml::array* array = node != nullptr ? node->as_array() : nullptr;
  if (array == nullptr || array->size() != 3)
    table.refuse(
        key, fmt::format("[x, y, z], each {}, or a table {{constant, sines, points, course}}", unit.range.expectation));
  Signal3 signals;
  for (std::size_t i = 0; i < 3; ++i)
    signals[i] = read_node(table, key, *array->get(i), fmt::format("{}[{}]", table.dotted(key), i), unit);
  return signals;
}

}  // namespace palpate
