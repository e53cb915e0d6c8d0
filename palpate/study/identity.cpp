// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <palpate/study/identity.hpp>
#include <sstream>
#include <stdexcept>

namespace palpate::study {

namespace {

/// Sorted keys, without comments.
nlohmann::json as_json(const toml::table& document) {
  std::ostringstream text;
  text << toml::json_formatter{document};
  return nlohmann::json::parse(text.str());
}

nlohmann::json as_json(const Parameter& p) {
  if (!p.sampled()) return {{"name", p.name}, {"values", p.values}};
  return {{"name", p.name}, {"range", {p.from, p.to}}, {"logarithmic", p.logarithmic}};
}

}  // namespace

void Sha256::Free::operator()(evp_md_ctx_st* context) const { EVP_MD_CTX_free(context); }

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  if (context_ == nullptr || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1)
    throw std::runtime_error("SHA-256 is not to be had from the cryptographic library");
}

void Sha256::add(std::string_view bytes) {
  if (EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) != 1) throw std::runtime_error("SHA-256 failed");
}

std::string Sha256::hexadecimal() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  if (EVP_DigestFinal_ex(context_.get(), digest.data(), &size) != 1) throw std::runtime_error("SHA-256 failed");
  std::string text;
  for (unsigned i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
  return text;
}

std::string sha256(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes);
  return hash.hexadecimal();
}

nlohmann::json canonical(const Plan& plan) {
  nlohmann::json parameters = nlohmann::json::array();
  for (const Parameter& p : plan.parameters) parameters.push_back(as_json(p));
  return {{"version", kResultsVersion},
          {"model", plan.model == Model::kScenario ? "scenario" : "single_update"},
          {"scenario", as_json(plan.base.scenario)},
          {"catheter", as_json(plan.base.catheter)},
          {"update", as_json(plan.base.update)},
          {"parameters", parameters},
          {"columns", column_names(plan.measures)},
          {"seed", plan.seed},
          {"samples", plan.samples},
          {"repeats", plan.repeats},
          {"shard_runs", plan.shard_runs},
          {"common_seeds", plan.common_seeds},
          {"skip_s", plan.skip_s}};
}

std::string plan_id(const Plan& plan) { return sha256(canonical(plan).dump()); }

std::string shard_id(const std::string& plan, const RunRange& range) {
  return sha256(fmt::format("{} {} {}", plan, range.first, range.end));
}

}  // namespace palpate::study
