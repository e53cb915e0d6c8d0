// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <palpate/study/plan.hpp>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace palpate::study {

/// Raised whenever a change of the program changes what a run gives, or how it is kept: results of before are then not
/// continued.
inline constexpr int kResultsVersion = 1;

/// SHA-256 (FIPS 180-4) of bytes that come piece by piece.
class Sha256 {
 public:
  Sha256();
  void add(std::string_view bytes);
  std::string hexadecimal();  ///< 64 digits; once, after the last add()

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};
std::string sha256(std::string_view bytes);

/// All that the results depend on, in one spelling: the files as they are read (comments, layout, order of keys and the
/// study's title do not count), the parameters, seeds, measures, and kResultsVersion. JSON, keys sorted.
nlohmann::json canonical(const Plan& plan);

/// SHA-256 of the canonical plan.
std::string plan_id(const Plan& plan);

/// SHA-256 of the plan's id and the runs [first, end): what a shard is, whoever computes it.
std::string shard_id(const std::string& plan, const RunRange& range);

}  // namespace palpate::study
