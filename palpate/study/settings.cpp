// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <optional>
#include <palpate/math/errors.hpp>
#include <palpate/recording/nearest_name.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/study/settings.hpp>

namespace palpate::study {

namespace {

/// Gives `store` the number, word or truth as the TOML type that it is.
template <typename Store>
void with_scalar(const nlohmann::json& value, const Store& store) {
  if (value.is_boolean()) return store(value.get<bool>());
  if (value.is_number_integer()) return store(value.get<std::int64_t>());
  if (value.is_number()) return store(value.get<double>());
  store(value.get<std::string>());
}

toml::array array_of(const nlohmann::json& values) {
  toml::array array;
  for (const nlohmann::json& each : values)
    each.is_array() ? array.push_back(array_of(each)) : with_scalar(each, [&](const auto& v) { array.push_back(v); });
  return array;
}

template <typename Store>
void with_toml_value(const nlohmann::json& value, const Store& store) {
  value.is_array() ? store(array_of(value)) : with_scalar(value, store);
}

/// "name[2]" -> "name", 2.
struct Key {
  std::string name;
  std::optional<std::size_t> index;
};

Key parse_key(std::string_view text) {
  const std::size_t open = text.find('[');
  if (open == std::string_view::npos) return {std::string(text), std::nullopt};
  const auto index = text.ends_with(']') ? parse_integer(text.substr(open + 1, text.size() - open - 2)) : std::nullopt;
  if (!index || *index < 0) throw InputError(fmt::format("expected KEY[i] with i from 0 on, not {}", printable(text)));
  return {std::string(text.substr(0, open)), static_cast<std::size_t>(*index)};
}

void put(toml::table& table, const Key& key, const nlohmann::json& value) {
  if (!key.index) {
    with_toml_value(value, [&](const auto& v) { table.insert_or_assign(key.name, v); });
    return;
  }
  toml::array* array = table.get_as<toml::array>(key.name);
  const std::size_t size = array != nullptr ? array->size() : 0;
  if (*key.index >= size)
    throw InputError(fmt::format("expected an element of {}, which has {} in the file", key.name, size));
  with_toml_value(value,
                  [&](const auto& v) { array->replace(array->cbegin() + static_cast<std::ptrdiff_t>(*key.index), v); });
}

toml::table& table_of(toml::table& document, const std::string& name) {
  if (toml::table* table = document.get_as<toml::table>(name)) return *table;
  if (document.contains(name)) throw InputError(fmt::format("expected a table {}, with a key behind it", name));
  return *document.insert(name, toml::table{}).first->second.as_table();
}

toml::table& sensor_of(toml::table& catheter, std::string_view name) {
  std::vector<std::string> names;
  if (toml::array* sensors = catheter.get_as<toml::array>("sensor"))
    for (toml::node& node : *sensors) {
      toml::table* sensor = node.as_table();
      if (sensor == nullptr) continue;
      names.push_back((*sensor)["name"].value_or(std::string()));
      if (names.back() == name) return *sensor;
    }
  if (names.empty()) throw InputError("expected a catheter file with a [[sensor]]");
  const std::vector<std::string_view> known(names.begin(), names.end());
  throw InputError(fmt::format("expected the name of a sensor; did you mean {}?", nearest_name(name, known)));
}

[[noreturn]] toml::table& refuse_name() {
  throw InputError(
      "expected scenario.[TABLE.]KEY, catheter.[TABLE.]KEY, catheter.sensor.NAME.KEY, filter.KEY or update.KEY");
}

/// `parts`: the name without its first word.
toml::table& find_table(std::string_view document, const std::vector<std::string_view>& parts, Documents& documents) {
  if (document == "update" && parts.size() == 1) return documents.update;
  if (document == "filter" && parts.size() == 1) return table_of(documents.catheter, "estimator");
  if (document == "scenario" && parts.size() == 1) return table_of(documents.scenario, "scenario");
  if (parts.size() == 2 && parts[0] == document) return refuse_name();  // [scenario], by a second name
  if (document == "scenario" && parts.size() == 2) return table_of(documents.scenario, std::string(parts[0]));
  if (document == "catheter" && parts.size() == 1) return table_of(documents.catheter, "catheter");
  if (document == "catheter" && parts.size() == 2) return table_of(documents.catheter, std::string(parts[0]));
  if (document == "catheter" && parts.size() == 3 && parts[0] == "sensor")
    return sensor_of(documents.catheter, parts[1]);
  return refuse_name();
}

}  // namespace

void put_setting(std::string_view name, const nlohmann::json& value, Documents& documents) {
  std::vector<std::string_view> parts = split(name, '.');
  constexpr std::string_view kDocuments[] = {"scenario", "catheter", "filter", "update"};
  const std::string_view document = parts.front();
  if (std::find(std::begin(kDocuments), std::end(kDocuments), document) == std::end(kDocuments))
    throw InputError(
        fmt::format("expected a name that begins with scenario, catheter, filter or update; did you mean {}?",
                    nearest_name(document, kDocuments)));
  parts.erase(parts.begin());
  const Key key = parse_key(parts.empty() ? std::string_view() : parts.back());
  put(find_table(document, parts, documents), key, value);
}

Documents documents_at(const Plan& plan, const std::vector<nlohmann::json>& values) {
  Documents documents = plan.base;
  for (std::size_t j = 0; j < values.size(); ++j) put_setting(plan.parameters[j].name, values[j], documents);
  return documents;
}

}  // namespace palpate::study
