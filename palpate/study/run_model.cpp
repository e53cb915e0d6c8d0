// SPDX-License-Identifier: Apache-2.0
#include <cctype>
#include <palpate/study/run_model.hpp>
#include <sstream>

namespace palpate::study {

std::string toml_text(const toml::table& document) {
  std::ostringstream text;
  text << toml::toml_formatter{document} << '\n';
  return text.str();
}

TextFile toml_lines(const toml::table& document, const std::string& name) {
  TextFile file{.name = name, .lines = {}};
  std::istringstream text(toml_text(document));
  for (std::string line; std::getline(text, line);) file.lines.push_back(line);
  return file;
}

std::string without_place(const Plan& plan, std::string message) {
  for (const std::string& source : {plan.scenario_source, plan.catheter_source, plan.source}) {
    if (source.empty() || !message.starts_with(source + ':')) continue;
    std::size_t at = source.size() + 1;
    while (at < message.size() && std::isdigit(static_cast<unsigned char>(message[at])) != 0) ++at;
    at = message.find_first_not_of(": ", at);
    return at == std::string::npos ? std::string() : message.substr(at);
  }
  return message;
}

std::unique_ptr<RunModel> make_model(const Plan& plan, const std::filesystem::path& scratch) {
  return plan.model == Model::kScenario ? make_scenario_model(plan, scratch) : make_update_model(plan);
}

void check_documents(const Plan& plan, const Documents& documents, const std::filesystem::path& scratch) {
  plan.model == Model::kScenario ? check_scenario_documents(plan, documents, scratch)
                                 : check_update_documents(plan, documents);
}

}  // namespace palpate::study
