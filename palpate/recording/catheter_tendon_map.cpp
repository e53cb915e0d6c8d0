// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/math/units.hpp>
#include <palpate/recording/catheter_tendon_map.hpp>

namespace palpate {
namespace {

constexpr NumberRange kPosition = {-1e6, 1e6, "a position in the unit of input, at most 1e6"};
constexpr NumberRange kCurvature = {-1000.0, 1000.0, "a curvature in 1/m, at most 1000"};
constexpr NumberRange kSigma = {0.0, 1000.0, "a standard deviation in 1/m, 0..1000, that of k1,0 more than 0"};

std::vector<double> column(const TomlTable& table, std::string_view key, std::size_t count) {
  return table.numbers(key, kCurvature, count, count);
}

std::vector<Eigen::Vector2d> branch(const TomlTable& table, std::string_view k1_key, std::string_view k2_key,
                                    std::size_t count, double k2_otherwise) {
  const std::vector<double> k1 = column(table, k1_key, count);
  const std::vector<double> k2 =
      table.has(k2_key) ? column(table, k2_key, count) : std::vector<double>(count, k2_otherwise);
  std::vector<Eigen::Vector2d> out;
  out.reserve(count);
  for (std::size_t i = 0; i < count; ++i) out.emplace_back(k1[i], k2[i]);
  return out;
}

std::string axis_of(const std::vector<Eigen::Vector2d>& branch, int axis) {
  std::vector<double> values;
  values.reserve(branch.size());
  for (const Eigen::Vector2d& k : branch) values.push_back(k(axis));
  return toml_array(values);
}

}  // namespace

std::string_view name_of(TendonInput input) {
  switch (input) {
    case TendonInput::kKnob:
      return "knob_rad";
    case TendonInput::kDisplacement:
      return "displacement_mm";
    case TendonInput::kTension:
      return "tension_N";
  }
  return "";
}

double si_per_unit(TendonInput input) { return input == TendonInput::kDisplacement ? kMetresPerMillimetre : 1.0; }

void read_tendon_map(const TomlTable& root, Catheter& catheter) {
  const auto table = root.table("tendon_map", {"input", "position", "pull_k1_per_m", "release_k1_per_m",
                                               "pull_k2_per_m", "release_k2_per_m", "sigma_per_m"});
  if (!table) return;
  TendonMap& map = catheter.tendon_map;
  map.present = true;
  table->text("input");
  map.input = table->choice<TendonInput>("input",
                                         {{"knob_rad", TendonInput::kKnob},
                                          {"displacement_mm", TendonInput::kDisplacement},
                                          {"tension_N", TendonInput::kTension}},
                                         TendonInput::kKnob);
  map.position = table->numbers("position", kPosition, 2, TendonMap::kMostPositions);
  for (double& position : map.position) position *= si_per_unit(map.input);
  const double k2_per_m = catheter.precurvature_per_m().y();
  map.pull_per_m = branch(*table, "pull_k1_per_m", "pull_k2_per_m", map.position.size(), k2_per_m);
  map.release_per_m = branch(*table, "release_k1_per_m", "release_k2_per_m", map.position.size(), k2_per_m);
  const auto sigma = table->optional_vector<2>("sigma_per_m", kSigma);
  if (!sigma || !(sigma->x() > 0.0)) table->refuse("sigma_per_m", "[k1, k2] standard deviations in 1/m, k1's above 0");
  map.sigma_per_m = *sigma;
}

void write_tendon_map(const TendonMap& map, std::string_view comment, TomlEdit& edit) {
  std::vector<double> position = map.position;
  for (double& p : position) p /= si_per_unit(map.input);
  const auto put = [&](std::string_view key, const std::string& value, std::string_view behind = {}) {
    edit.remove("tendon_map", key);  // so that the keys stand in order, below the header
    edit.set("tendon_map", key, value, behind);
  };
  put("sigma_per_m", toml_array({map.sigma_per_m.x(), map.sigma_per_m.y()}, 4));
  put("release_k2_per_m", axis_of(map.release_per_m, 1));
  put("pull_k2_per_m", axis_of(map.pull_per_m, 1));
  put("release_k1_per_m", axis_of(map.release_per_m, 0));
  put("pull_k1_per_m", axis_of(map.pull_per_m, 0));
  put("position", toml_array(position, 9));
  put("input", fmt::format("\"{}\"", name_of(map.input)), comment);
}

}  // namespace palpate
