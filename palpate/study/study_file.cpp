// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <palpate/math/errors.hpp>
#include <palpate/recording/toml_table.hpp>
#include <palpate/study/parameter_check.hpp>
#include <palpate/study/study_file.hpp>

namespace palpate::study {

namespace {

constexpr NumberRange kSeed = {0.0, 9007199254740992.0, "a whole number, 0..2^53"};
constexpr NumberRange kCount = {1.0, 1e9, "a whole number, 1..1e9"};
constexpr NumberRange kShard = {1.0, 1e6, "a whole number, 1..1e6"};
constexpr NumberRange kSkip_s = {0.0, 86400.0, "a time in seconds, 0..86400"};
constexpr NumberRange kAnyNumber = {-1e300, 1e300, "a number"};
constexpr double kMostRuns = 1e9;
constexpr std::uint64_t kMostShards = 10000000;

std::uint64_t whole(const TomlTable& table, const char* key, const NumberRange& range, std::uint64_t fallback) {
  if (!table.has(key)) return fallback;
  const double value = table.number(key, range);
  if (!table.find(key)->is_integer()) table.refuse(key, range.expectation);
  return static_cast<std::uint64_t>(value);
}

toml::table read_document(const TomlTable& table, const char* key, const std::filesystem::path& folder,
                          std::string& source) {
  const std::filesystem::path path = folder / table.text(key);
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    table.refuse(key, fmt::format("a file; there is no file {}", path.string()));
  source = path.string();
  return parse_toml(read_text_file(path));
}

/// The scenario names its catheter file; a key of the study goes before it.
void read_documents(const TomlTable& head, const std::filesystem::path& folder, Plan& plan) {
  if (plan.model == Model::kSingleUpdate) {
    if (head.has("scenario")) head.refuse("scenario", "no such key beside model = \"single_update\"");
    plan.base.catheter = read_document(head, "catheter", folder, plan.catheter_source);
    return;
  }
  plan.base.scenario = read_document(head, "scenario", folder, plan.scenario_source);
  if (head.has("catheter")) {
    plan.base.catheter = read_document(head, "catheter", folder, plan.catheter_source);
    return;
  }
  const auto scenario_folder = std::filesystem::path(plan.scenario_source).parent_path();
  const TomlTable scenario(plan.base.scenario, "", plan.scenario_source,
                           {"schema", "scenario", "truth", "load", "handle", "flow", "stiffness", "tracker"});
  const auto table = scenario.table("scenario", {"name", "catheter", "duration_s", "seed"});
  if (!table) scenario.refuse("scenario", "a table [scenario] with catheter and duration_s");
  plan.base.catheter = read_document(*table, "catheter", scenario_folder, plan.catheter_source);
}

nlohmann::json value_of(const toml::node& node) {
  if (const auto* v = node.as_integer()) return v->get();
  if (const auto* v = node.as_floating_point()) return v->get() + 0.0;  // -0 is 0: they are one value
  if (const auto* v = node.as_boolean()) return v->get();
  if (const auto* v = node.as_string()) return v->get();
  nlohmann::json array = nlohmann::json::array();
  if (const auto* list = node.as_array())
    for (const toml::node& each : *list) array.push_back(value_of(each));
  return array;
}

void read_values(const TomlTable& table, Parameter& p) {
  const toml::array* values = table.find("values")->as_array();
  if (values == nullptr || values->empty()) table.refuse("values", "at least one value, such as [0.1, 0.2]");
  for (const toml::node& node : *values) {
    const nlohmann::json value = value_of(node);
    const bool finite = !value.is_number() || std::isfinite(value.get<double>());
    if (node.is_table() || !finite) table.refuse("values", "finite numbers, words, true or false, or arrays of them");
    if (!p.values.empty() && std::string_view(value.type_name()) != p.values.front().type_name())
      table.refuse("values", "values of one kind: numbers, words, true and false, or arrays");
    if (std::find(p.values.begin(), p.values.end(), value) != p.values.end())
      table.refuse("values", fmt::format("values that differ, here {} stands twice", value.dump()));
    p.values.push_back(value);
  }
}

/// Names of columns: A and a are one.
bool same_column(const std::string& a, const std::string& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
    return x == y || (x < 128 && y < 128 && std::tolower(x) == std::tolower(y));
  });
}

Parameter read_parameter(const TomlTable& table, const std::vector<Parameter>& others) {
  Parameter p{.name = table.text("name"), .values = {}};
  for (const Parameter& other : others)
    if (same_column(other.name, p.name)) table.refuse("name", "a parameter that no other [[vary]] has, in any case");
  if (table.has("values") == table.has("range"))
    table.refuse(table.has("values") ? "range" : "values", "either values = [...] or range = [from, to]");
  if (table.has("values")) {
    if (table.has("scale")) table.refuse("scale", "this key only together with range");
    read_values(table, p);
    return p;
  }
  const std::vector<double> range = table.numbers("range", kAnyNumber, 2, 2);
  p.from = range[0];
  p.to = range[1];
  p.logarithmic = table.choice<bool>("scale", {{"linear", false}, {"logarithmic", true}}, false);
  if (!(p.to > p.from)) table.refuse("range", "[from, to] with to above from");
  if (p.logarithmic && !(p.from > 0.0)) table.refuse("range", "a range above 0 beside scale = \"logarithmic\"");
  return p;
}

void read_measures(const TomlTable& head, Plan& plan) {
  for (const std::string& name : head.texts("measure")) {
    const auto found = std::find(kMeasureNames.begin(), kMeasureNames.end(), name);
    if (found == kMeasureNames.end()) head.refuse("measure", fmt::format("some of {}", fmt::join(kMeasureNames, ", ")));
    const auto measure = static_cast<Measure>(found - kMeasureNames.begin());
    if (std::find(plan.measures.begin(), plan.measures.end(), measure) == plan.measures.end())
      plan.measures.push_back(measure);
  }
  if (!head.has("measure"))
    for (std::size_t i = 0; i < kMeasureNames.size(); ++i) plan.measures.push_back(static_cast<Measure>(i));
  if (plan.measures.empty()) head.refuse("measure", fmt::format("some of {}", fmt::join(kMeasureNames, ", ")));
}

void read_counts(const TomlTable& head, Plan& plan) {
  plan.seed = whole(head, "seed", kSeed, 1);
  plan.repeats = whole(head, "repeats", kCount, 1);
  plan.shard_runs = whole(head, "shard_runs", kShard, plan.model == Model::kScenario ? 20 : 500);
  plan.common_seeds = head.flag("common_seeds", false);
  plan.skip_s = head.number("skip_s", kSkip_s, 1.0);
  const bool sampled =
      std::any_of(plan.parameters.begin(), plan.parameters.end(), [](const auto& p) { return p.sampled(); });
  if (head.has("samples") != sampled)
    head.refuse("samples", sampled ? "points of the Latin hypercube, 1..1e9, for a [[vary]] has a range"
                                   : "this key only together with a [[vary]] that has a range");
  plan.samples = whole(head, "samples", kCount, 1);
  double runs = static_cast<double>(plan.samples) * static_cast<double>(plan.repeats);
  for (const Parameter& p : plan.parameters) runs *= p.sampled() ? 1.0 : static_cast<double>(p.values.size());
  if (runs > kMostRuns) head.refuse("repeats", fmt::format("at most 1e9 runs in all, not {:g}", runs));
  if (plan.shards() > kMostShards)
    head.refuse("shard_runs", fmt::format("at most 1e7 shards in all, not {:g}", static_cast<double>(plan.shards())));
}

}  // namespace

Plan read_study_file(const std::filesystem::path& path) {
  const TextFile text = read_text_file(path);
  const toml::table table = parse_toml(text);
  const TomlTable root(table, "", text.name, {"schema", "study", "update", "vary"});
  root.number("schema", {1.0, 1.0, "1, the schema this program reads"});
  const auto head = root.table("study", {"name", "model", "scenario", "catheter", "seed", "samples", "repeats",
                                         "shard_runs", "common_seeds", "skip_s", "measure"});
  if (!head) root.refuse("study", "a table [study]");
  Plan plan;
  plan.name = head->text("name", path.stem().string());
  plan.source = text.name;
  plan.model = head->choice<Model>("model", {{"scenario", Model::kScenario}, {"single_update", Model::kSingleUpdate}},
                                   Model::kScenario);
  read_documents(*head, path.parent_path(), plan);
  if (const toml::table* update = table.get_as<toml::table>("update"))
    plan.base.update = *update;
  else if (root.has("update"))
    root.refuse("update", "a table [update]");
  if (root.has("update") && plan.model == Model::kScenario)
    root.refuse("update", "this table only beside model = \"single_update\"");
  const std::vector<TomlTable> vary = root.tables("vary", {"name", "values", "range", "scale"});
  for (const TomlTable& each : vary) plan.parameters.push_back(read_parameter(each, plan.parameters));
  read_measures(*head, plan);
  read_counts(*head, plan);
  check_parameters(plan, vary);
  return plan;
}

}  // namespace palpate::study
