// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <palpate/observer/estimate.hpp>
#include <palpate/recording/output_file.hpp>
#include <string>
#include <vector>

namespace palpate {

/// Writes one row for every frame. The header is part of the format contract:
/// time_s, force (tip) [N], sigma [N], covariances [N^2], force (base) [N], status, sensors_used, nis, dof,
/// evaluations; where asked for, the forecast force (tip) [N] and its sigma [N].
class EstimateCsvWriter {
 public:
  explicit EstimateCsvWriter(const std::filesystem::path& path, bool with_forecast = false);
  void write(const Estimate& estimate);
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
  bool with_forecast_;
};

/// What is needed of an estimate to judge it.
struct EstimateRow {
  double time_s = 0.0;
  Vector3d force_tip_N = Vector3d::Zero();
  Matrix3d covariance_tip_N2 = Matrix3d::Zero();
  EstimateStatus status = EstimateStatus::kHeld;
};

/// Throws InputError naming file, line, field and value.
std::vector<EstimateRow> read_estimate_csv(const std::filesystem::path& path);

}  // namespace palpate
