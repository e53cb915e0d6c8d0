// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <palpate/observer/estimate.hpp>
#include <palpate/recording/output_file.hpp>

namespace palpate {

/// Writes for every frame what its sigma is made of and what the frame cannot tell:
/// time_s, not_observable (words, joined by ';', empty where all is observable), the force part of the weakest
/// direction, tip axes, one prior sigma long [N], and its sigma by the frame alone, in prior sigmas; then for each
/// UncertaintySource sigma_NAME_x_N, sigma_NAME_y_N, sigma_NAME_z_N.
class BudgetCsvWriter {
 public:
  explicit BudgetCsvWriter(const std::filesystem::path& path);
  void write(const Estimate& estimate);
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
};

}  // namespace palpate
