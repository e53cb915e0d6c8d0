// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/recording/load_cases.hpp>
#include <palpate/recording/toml_table.hpp>

namespace palpate {
namespace {

constexpr NumberRange kSchema = {1.0, 1.0, "1, the schema this program reads"};
constexpr NumberRange kForce = {-1000.0, 1000.0, "a force in N, at most 1000 (is it in mN or in grams?)"};
constexpr NumberRange kSigma = {0.0, 100.0, "a standard deviation in mm, 0..100"};
constexpr NumberRange kTime = {-1e12, 1e12, "a time in s"};

struct Interval {
  double from_s = 0.0, to_s = 0.0;
};

Interval read_interval(const TomlTable& table, std::string_view key) {
  const auto times_s = table.optional_vector<2>(key, kTime);
  if (!times_s || !(times_s->x() < times_s->y())) table.refuse(key, "[from, to] in s, from before to");
  return {times_s->x(), times_s->y()};
}

/// Keys that belong to the other way of giving the shape.
void refuse_keys(const TomlTable& table, std::initializer_list<std::string_view> keys, std::string_view expectation) {
  for (const std::string_view key : keys)
    if (table.has(key)) table.refuse(key, expectation);
}

class CaseReader {
 public:
  CaseReader(const std::filesystem::path& folder, const Catheter& catheter) : folder_(folder), catheter_(catheter) {}

  LoadCaseEntry read(const TomlTable& table) const {
    LoadCaseEntry entry;
    entry.name = table.text("name");
    const auto force_N = table.optional_vector<3>("force_base_N", kForce);
    if (!force_N) table.refuse("force_base_N", "[x, y, z] in N along the base axes; [0.0, 0.0, 0.0] without a load");
    entry.force_base_N = *force_N;
    if (table.has("points") == table.has("recording"))
      table.refuse(table.has("points") ? "recording" : "points", "either points or a recording");
    table.has("points") ? read_points(table, entry) : read_recording(table, entry);
    return entry;
  }

 private:
  void read_points(const TomlTable& table, LoadCaseEntry& entry) const {
    refuse_keys(table, {"interval_s", "reference_s", "reference_shape", "reference_sigma_mm"},
                "it beside recording only, not beside points");
    entry.points_file = folder_ / table.text("points");
    const bool in_tracker_frame = table.choice<bool>("frame", {{"base", false}, {"tracker", true}}, false);
    if (in_tracker_frame && catheter_.base.tracked)
      table.refuse("frame", "\"base\", for the base of this catheter is tracked and has no fixed place");
    entry.points = parse_load_points(read_text_file(entry.points_file), catheter_,
                                     {.case_name = entry.name, .in_tracker_frame = in_tracker_frame});
  }

  void read_recording(const TomlTable& table, LoadCaseEntry& entry) const {
    refuse_keys(table, {"frame"},
                "it beside points only: [base] of the catheter file says where a recording's base is");
    entry.recording = folder_ / table.text("recording");
    const Interval rest = read_interval(table, "interval_s");
    entry.from_s = rest.from_s;
    entry.to_s = rest.to_s;
    if (!table.has("reference_s")) {
      refuse_keys(table, {"reference_shape", "reference_sigma_mm"}, "it beside reference_s only");
      return;
    }
    const Interval reference = read_interval(table, "reference_s");
    const bool straight = table.choice<bool>("reference_shape", {{"unloaded", false}, {"straight", true}}, false);
    entry.reference_sigma_m = table.number("reference_sigma_mm", kSigma, 0.0) * kMetresPerMillimetre;
    entry.reference = {.given = true, .from_s = reference.from_s, .to_s = reference.to_s, .straight = straight};
  }

  const std::filesystem::path& folder_;
  const Catheter& catheter_;
};

}  // namespace

LoadCaseFile read_load_cases(const std::filesystem::path& path, const Catheter& catheter) {
  const TextFile text = read_text_file(path);
  const toml::table parsed = parse_toml(text);
  const TomlTable root(parsed, "", text.name, {"schema", "own_weight", "clamp", "case"});
  root.number("schema", kSchema, 1.0);
  LoadCaseFile file;
  file.source = text.name;
  file.own_weight_subtracted = root.choice<bool>("own_weight", {{"included", false}, {"subtracted", true}}, false);
  file.clamp_fixed = root.choice<bool>("clamp", {{"moved", false}, {"fixed", true}}, false);
  const std::filesystem::path folder = path.parent_path();
  const CaseReader reader(folder, catheter);
  for (const TomlTable& table :
       root.tables("case", {"name", "force_base_N", "points", "frame", "recording", "interval_s", "reference_s",
                            "reference_shape", "reference_sigma_mm"})) {
    LoadCaseEntry entry = reader.read(table);
    for (const LoadCaseEntry& other : file.cases)
      if (other.name == entry.name) table.refuse("name", "each name once");
    file.cases.push_back(std::move(entry));
  }
  if (file.cases.empty()) root.refuse("case", "at least one [[case]]");
  return file;
}

}  // namespace palpate
