// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <palpate/observer/estimate.hpp>
#include <palpate/observer/options.hpp>
#include <palpate/recording/output_file.hpp>
#include <string>
#include <vector>

namespace palpate {

/// Which columns an estimate CSV has behind those of the contract.
struct EstimateColumns {
  bool stiffness = false;     ///< EI1_Nm2, EI2_Nm2, each followed by its sigma
  bool torsion = false;       ///< GJ_Nm2 likewise
  bool precurvature = false;  ///< k1_0_per_m, k2_0_per_m likewise
  bool forecast = false;      ///< the forecast force (tip) [N] and its sigma [N]

  /// What is estimated, or asked for.
  static EstimateColumns of(const ObserverOptions& options);
};

/// Writes one row for every frame. The header is part of the format contract:
/// time_s, force (tip) [N], sigma [N], covariances [N^2], force (base) [N], status, sensors_used, nis, dof,
/// evaluations; then EstimateColumns.
class EstimateCsvWriter {
 public:
  explicit EstimateCsvWriter(const std::filesystem::path& path, const EstimateColumns& columns = {});
  void write(const Estimate& estimate);
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
  EstimateColumns columns_;
};

/// What is needed of an estimate to judge it.
struct EstimateRow {
  double time_s = 0.0;
  Vector3d force_tip_N = Vector3d::Zero();
  Matrix3d covariance_tip_N2 = Matrix3d::Zero();
  EstimateStatus status = EstimateStatus::kHeld;
  int sensors_used = -1;  ///< -1: the file has no such column, nor is one needed to judge the force
  double nis = 0.0;
  int dof = 0;               ///< 0: nothing was used, or the file has no such columns
  ShaftEstimate shaft = {};  ///< estimated values; zero: the file has no such columns. Sigmas are not read
  std::size_t line = 0;      ///< of the file; 0: not from a file
};

/// The same of an estimate that was just made.
EstimateRow row_of(const Estimate& estimate);

/// Throws InputError naming file, line, field and value.
std::vector<EstimateRow> read_estimate_csv(const std::filesystem::path& path);

}  // namespace palpate
