// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <palpate/store/database.hpp>
#include <string>
#include <vector>

namespace palpate::study {

/// Of one column over a group of runs; NaN where the group is empty. Quantiles between two values are linear.
struct Spread {
  std::uint64_t runs = 0;
  double mean = 0.0, low = 0.0, median = 0.0, high = 0.0;  ///< low, high: 5 % and 95 % of the runs lie below
};
Spread spread_of(std::vector<double> values);

/// The runs told apart by one parameter: its values, or tenths of its range.
struct Groups {
  std::string parameter;
  bool numeric = false;  ///< `x` is the parameter's value; otherwise 1, 2, ...
  bool logarithmic = false;
  std::vector<std::string> labels;  ///< "0.28", "ekf", "0.1 .. 0.2"
  std::vector<double> x;            ///< value, or middle of the tenth
};
Groups groups_of(const nlohmann::json& parameter);

/// Of each group, over the runs that did not fail. Memory: eight bytes a run.
std::vector<Spread> spreads_by(const store::Database& database, const nlohmann::json& parameter,
                               const std::string& column);
Spread spread_over_all(const store::Database& database, const std::string& column);

}  // namespace palpate::study
