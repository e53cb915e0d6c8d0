// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/scenario_load.hpp>
#include <palpate/recording/scenario_signals.hpp>
#include <palpate/simulation/virtual_run.hpp>

namespace palpate {
namespace {

constexpr SignalUnit kForce = {{-100.0, 100.0, "a force in N, at most 100"}, 1.0};
constexpr SignalUnit kPlace = {{-1e4, 1e4, "a place in mm, at most 10000"}, kMetresPerMillimetre};
constexpr SignalUnit kMotion = {{-1000.0, 1000.0, "a way in mm, at most 1000"}, kMetresPerMillimetre};
constexpr NumberRange kMass_g = {1e-6, 1e4, "a mass in g, more than 0, at most 10000"};
constexpr NumberRange kGap_mm = {0.0, 1000.0, "a distance in mm, 0..1000"};
constexpr NumberRange kDirection = {-1e6, 1e6, "part of a direction"};
constexpr NumberRange kStiffness = {1e-6, 1e6, "a stiffness in N/m, more than 0, at most 1e6"};
constexpr NumberRange kTangential = {0.0, 1e6, "a stiffness in N/m, 0..1e6"};
constexpr NumberRange kFriction = {0.0, 10.0, "a coefficient of friction, 0..10"};
constexpr NumberRange kBeats = {1.0, 1000.0, "beats a minute, 1..1000"};
constexpr NumberRange kBeat_mm = {0.0, 100.0, "an amplitude in mm, 0..100"};
constexpr NumberRange kSpread = {0.0, 49.0, "percent of the mean, 0..49"};

constexpr double kKilogramsPerGram = 1e-3;

ForceLoad read_force(const TomlTable& table) {
  if (table.has("force_tip_N") && table.has("force_base_N"))
    table.refuse("force_base_N", "either force_tip_N or force_base_N");
  if (!table.has("force_tip_N") && !table.has("force_base_N"))
    table.refuse("force_tip_N", "[x, y, z] in N, in the tip's axes, or force_base_N, in the base's");
  const bool in_base = table.has("force_base_N");
  return {.in_base = in_base, .force_N = read_signals(table, in_base ? "force_base_N" : "force_tip_N", kForce)};
}

PulleyLoad read_pulley(const TomlTable& table) {
  return {.mass_kg = table.number("mass_g", kMass_g) * kKilogramsPerGram,
          .pulley_base_m = read_signals(table, "pulley_base_mm", kPlace)};
}

WallLoad::Heart read_heart(const TomlTable& wall) {
  const auto table =
      wall.table("heart", {"beats_per_min", "amplitude_mm", "interval_spread_percent", "size_spread_percent"});
  if (!table) return {};
  return {.beats_per_min = table->number("beats_per_min", kBeats),
          .amplitude_m = table->number("amplitude_mm", kBeat_mm) * kMetresPerMillimetre,
          .interval_spread = 0.01 * table->number("interval_spread_percent", kSpread, 0.0),
          .size_spread = 0.01 * table->number("size_spread_percent", kSpread, 0.0)};
}

Vector3d read_direction(const TomlTable& table, std::string_view key, const Vector3d& fallback) {
  const Vector3d direction = table.optional_vector<3>(key, kDirection).value_or(fallback);
  if (!(direction.norm() > 1e-6)) table.refuse(key, "[x, y, z], a direction, not zero");
  return direction.normalized();
}

/// The first frame, touched by nothing.
Truth first_truth(const Scenario& scenario, const std::string& file) {
  try {
    return run_scenario(scenario).truth.front();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: without [load]: {}", file, error.what()));
  }
}

/// The flexible end in the first frame, touched by nothing, in the base frame as it stands with the handle at zero.
Pose unloaded_tip(Scenario scenario, const std::string& file) {
  scenario.load = ForceLoad{};
  scenario.flow = {};
  scenario.duration_s = 1.0 / scenario.tracker.rate_hz;
  scenario.tracker.dropped_share = 0.0;
  const Truth first = first_truth(scenario, file);
  return scenario.catheter.base.T_tracker_base.inverse() * first.T_tracker_base * first.T_base_tip;
}

/// Either in the base, by point_base_mm and normal_base, or by the tip, by gap_mm and normal_tip.
void place_wall(const TomlTable& table, const Scenario& scenario, WallLoad& wall) {
  const bool by_tip = table.has("gap_mm");
  for (const char* key : {"point_base_mm", "normal_base"})
    if (by_tip && table.has(key)) table.refuse(key, "point_base_mm and normal_base, or gap_mm and normal_tip");
  if (!by_tip) {
    if (table.has("normal_tip")) table.refuse("normal_tip", "this key only together with gap_mm");
    for (const char* key : {"point_base_mm", "normal_base"})
      if (!table.has(key)) table.refuse(key, "[x, y, z] of the wall in the base, or gap_mm in front of the tip");
    wall.point_base_m = *table.optional_vector<3>("point_base_mm", kPlace.range) * kMetresPerMillimetre;
    wall.normal_base = read_direction(table, "normal_base", wall.normal_base);
    return;
  }
  const double gap_m = table.number("gap_mm", kGap_mm) * kMetresPerMillimetre;
  const Vector3d normal_tip = read_direction(table, "normal_tip", -Vector3d::UnitZ());
  const Pose T_base_tip = unloaded_tip(scenario, table.file());
  wall.normal_base = T_base_tip.R * normal_tip;
  wall.point_base_m = T_base_tip * scenario.catheter.rod.contact_offset_m - gap_m * wall.normal_base;
}

WallLoad read_wall(const TomlTable& table, const Scenario& scenario) {
  WallLoad wall;
  wall.stiffness_N_per_m = table.number("stiffness_N_per_m", kStiffness);
  wall.tangential_stiffness_N_per_m = table.number("tangential_stiffness_N_per_m", kTangential, 0.0);
  wall.friction = table.number("friction", kFriction, 0.0);
  if ((wall.friction > 0.0) != (wall.tangential_stiffness_N_per_m > 0.0))
    table.refuse(wall.friction > 0.0 ? "tangential_stiffness_N_per_m" : "friction",
                 "friction and tangential_stiffness_N_per_m both more than 0, or both 0 or absent");
  wall.along_normal_m = read_signal(table, "along_normal_mm", kMotion, {});
  wall.heart = read_heart(table);
  place_wall(table, scenario, wall);
  return wall;
}

enum class Kind : std::uint8_t { kThere, kWeight, kTissue };

}  // namespace

void read_load(const TomlTable& root, Scenario& scenario) {
  const auto any = root.table("load", {"kind", "force_tip_N", "force_base_N", "mass_g", "pulley_base_mm",
                                       "point_base_mm", "normal_base", "gap_mm", "normal_tip", "stiffness_N_per_m",
                                       "tangential_stiffness_N_per_m", "friction", "along_normal_mm", "heart"});
  if (!any) return;
  if (!any->has("kind")) any->refuse("kind", "one of 'force', 'pulley', 'wall'");
  switch (any->choice<Kind>("kind", {{"force", Kind::kThere}, {"pulley", Kind::kWeight}, {"wall", Kind::kTissue}},
                            Kind::kThere)) {
    case Kind::kThere:
      scenario.load = read_force(*root.table("load", {"kind", "force_tip_N", "force_base_N"}));
      return;
    case Kind::kWeight:
      scenario.load = read_pulley(*root.table("load", {"kind", "mass_g", "pulley_base_mm"}));
      return;
    case Kind::kTissue:
      scenario.load = read_wall(
          *root.table("load", {"kind", "point_base_mm", "normal_base", "gap_mm", "normal_tip", "stiffness_N_per_m",
                               "tangential_stiffness_N_per_m", "friction", "along_normal_mm", "heart"}),
          scenario);
  }
}

}  // namespace palpate
