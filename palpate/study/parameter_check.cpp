// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/math/errors.hpp>
#include <palpate/study/parameter_check.hpp>
#include <palpate/study/run_model.hpp>
#include <palpate/study/scratch_folder.hpp>
#include <palpate/study/settings.hpp>

namespace palpate::study {

namespace {

/// "estimator.methud = ...: expected a known key; did you mean method?": the same of the setting's whole name.
std::string nearest_setting(const std::string& name, const std::string& reason) {
  constexpr std::string_view kMeant = "expected a known key; did you mean ";
  const std::size_t meant = reason.find(kMeant);
  if (meant == std::string::npos || !reason.ends_with('?')) return {};
  const std::size_t from = meant + kMeant.size();
  const std::string nearest = reason.substr(from, reason.size() - from - 1);
  const std::string refused = reason.substr(0, reason.find(" = "));  // a dotted key
  const std::string unknown = refused.substr(refused.rfind('.') + 1);
  const std::size_t at = name.rfind("." + unknown);
  return at == std::string::npos ? std::string()
                                 : name.substr(0, at + 1) + nearest + name.substr(at + 1 + unknown.size());
}

void check_value(const Plan& plan, const Parameter& parameter, const nlohmann::json& value, const TomlTable& place,
                 const std::filesystem::path& scratch) {
  Documents documents = plan.base;
  try {
    put_setting(parameter.name, value, documents);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", place.describe("name"), error.what()));
  }
  const bool of_update = parameter.name.starts_with("update."), of_scenario = parameter.name.starts_with("scenario.");
  if (plan.model == Model::kScenario ? of_update : of_scenario)
    place.refuse("name", plan.model == Model::kScenario
                             ? "scenario., catheter. or filter. beside model = \"scenario\""
                             : "catheter., filter. or update. beside model = \"single_update\"");
  if (parameter.name == "scenario.catheter" || parameter.name == "scenario.seed")
    place.refuse("name", "another setting: catheter and seed are the study's own");
  try {
    check_documents(plan, documents, scratch);
  } catch (const InputError& error) {
    const std::string reason = without_place(plan, error.what());
    if (const std::string nearest = nearest_setting(parameter.name, reason); !nearest.empty())
      place.refuse("name", fmt::format("a known setting; did you mean {}?", nearest));
    throw InputError(fmt::format("{}: with {}: {}", place.describe("name"), value.dump(), reason));
  }
}

std::vector<nlohmann::json> values_to_try(const Parameter& p) {
  return p.sampled() ? std::vector<nlohmann::json>{p.from, p.to} : p.values;
}

/// Two names of one number: it matters which is put last, and a table over the other one would tell nothing.
bool meet(const Plan& plan, const Parameter& a, const Parameter& b) {
  const nlohmann::json value = values_to_try(a).front();
  for (const nlohmann::json& other : values_to_try(b)) {
    Documents a_first = plan.base, b_first = plan.base;
    put_setting(a.name, value, a_first);
    put_setting(b.name, other, a_first);
    put_setting(b.name, other, b_first);
    put_setting(a.name, value, b_first);
    if (a_first.scenario != b_first.scenario || a_first.catheter != b_first.catheter ||
        a_first.update != b_first.update)
      return true;
  }
  return false;
}

}  // namespace

void check_parameters(const Plan& plan, const std::vector<TomlTable>& vary) {
  const ScratchFolder scratch;
  check_documents(plan, plan.base, scratch.path());
  for (std::size_t j = 0; j < vary.size(); ++j) {
    const Parameter& p = plan.parameters[j];
    for (const nlohmann::json& value : values_to_try(p)) check_value(plan, p, value, vary[j], scratch.path());
    for (std::size_t i = 0; i < j; ++i)
      if (meet(plan, plan.parameters[i], p))
        vary[j].refuse("name", fmt::format("a setting that {} does not set, too", plan.parameters[i].name));
  }
}

}  // namespace palpate::study
