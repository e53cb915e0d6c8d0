// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>
#include <palpate/recording/catheter_estimator.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/catheter_sensors.hpp>
#include <palpate/recording/catheter_shaft.hpp>
#include <palpate/recording/catheter_tendon_map.hpp>

namespace palpate {
namespace {

constexpr NumberRange kTime_s = {-1e15, 1e15, "a time of the recording in seconds"};

void read_tendon(const TomlTable& root, Tendon& tendon) {
  const auto table = root.table("tendon", {"model", "offset_mm", "moment_sigma_percent"});
  if (!table) return;
  tendon.present = true;
  tendon.model = table->choice<TendonModel>(
      "model", {{"couple", TendonModel::kCouple}, {"end_moment", TendonModel::kEndMoment}}, TendonModel::kCouple);
  tendon.offset_m =
      table->number("offset_mm", {1e-6, 100.0, "a length in mm, more than 0, at most 100"}, 0.0) * kMetresPerMillimetre;
  tendon.moment_sigma_fraction = 0.01 * table->number("moment_sigma_percent", {0.0, 100.0, "percent, 0..100"}, 0.0);
}

void read_reference(const TomlTable& root, ReferenceInterval& reference) {
  const auto table = root.table("reference", {"from_s", "to_s", "shape"});
  if (!table) return;
  reference.given = true;
  reference.from_s = table->number("from_s", kTime_s);
  reference.to_s = table->number("to_s", kTime_s);
  if (!(reference.to_s > reference.from_s)) table->refuse("to_s", "a time later than from_s");
  reference.straight = table->choice<bool>("shape", {{"unloaded", false}, {"straight", true}}, false);
}

KnownLoad read_known_load(const TomlTable& table) {
  constexpr NumberRange kForce_N = {-1000.0, 1000.0, "a force in N, at most 1000"};
  const auto in_tip = table.optional_vector<3>("force_tip_N", kForce_N);
  const auto in_base = table.optional_vector<3>("force_base_N", kForce_N);
  if (in_tip && in_base) table.refuse("force_base_N", "either force_tip_N or force_base_N");
  if (!in_tip && !in_base)
    table.refuse("force_tip_N", "[x, y, z] in N, in the tip's axes, or force_base_N, in the base's");
  return {.present = true,
          .in_base = in_base.has_value(),
          .force_N = in_base ? *in_base : *in_tip,
          .sigma_N = table.number("sigma_N", {1e-12, 1000.0, "a standard deviation in N, more than 0, at most 1000"})};
}

void read_known_loads(const TomlTable& root, std::vector<KnownLoadInterval>& intervals) {
  for (const TomlTable& table :
       root.tables("known_load", {"from_s", "to_s", "force_tip_N", "force_base_N", "sigma_N"})) {
    const double from_s = table.number("from_s", kTime_s), to_s = table.number("to_s", kTime_s);
    if (!(to_s > from_s)) table.refuse("to_s", "a time later than from_s");
    for (const KnownLoadInterval& other : intervals)
      if (from_s < other.to_s && other.from_s < to_s)
        table.refuse("from_s", fmt::format("times outside the other known loads, here {} to {} s overlaps {} to {} s",
                                           from_s, to_s, other.from_s, other.to_s));
    intervals.push_back({from_s, to_s, read_known_load(table)});
  }
}

CatheterFile read_root(const TomlTable& root) {
  root.number("schema", {1.0, 1.0, "1, the schema this program reads"}, 1.0);
  CatheterFile file;
  read_shaft(root, file.catheter);
  read_tendon(root, file.catheter.tendon);
  read_tendon_map(root, file.catheter);
  read_sensors(root, file.catheter);
  read_estimator(root, file.observer);
  if (const auto recording = root.table("recording", {"ignore_sensors"})) {
    file.ignore_sensors = recording->texts("ignore_sensors");
  }
  read_reference(root, file.reference);
  read_known_loads(root, file.known_loads);
  return file;
}

}  // namespace

CatheterFile read_catheter_file(const std::filesystem::path& path) { return parse_catheter(read_text_file(path)); }

CatheterFile parse_catheter(const TextFile& text) {
  const toml::table table = parse_toml(text);
  CatheterFile file = read_root(TomlTable(table, "", text.name,
                                          {"schema", "catheter", "tendon", "tendon_map", "gravity", "base", "sensor",
                                           "estimator", "recording", "reference", "tracker", "known_load"}));
  try {
    file.catheter.validate();
    file.observer.validate();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", text.name, error.what()));
  }
  return file;
}

std::vector<std::size_t> attach_known_loads(std::span<const KnownLoadInterval> intervals,
                                            std::span<TrackerFrame> frames) {
  std::vector<std::size_t> inside(intervals.size(), 0);
  for (TrackerFrame& frame : frames) {
    for (std::size_t i = 0; i < intervals.size(); ++i) {
      if (!(frame.time_s >= intervals[i].from_s && frame.time_s <= intervals[i].to_s)) continue;
      frame.known_load = intervals[i].load;
      ++inside[i];
    }
  }
  return inside;
}

}  // namespace palpate
