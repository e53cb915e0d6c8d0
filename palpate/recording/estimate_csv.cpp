// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <palpate/recording/estimate_csv.hpp>
#include <palpate/recording/text_table.hpp>
#include <type_traits>

namespace palpate {

EstimateColumns EstimateColumns::of(const ObserverOptions& options) {
  return {.stiffness = options.estimate_stiffness,
          .torsion = options.estimate_stiffness && options.free_torsion,
          .precurvature = options.estimate_precurvature,
          .forecast = options.forecast_s > 0.0};
}

EstimateCsvWriter::EstimateCsvWriter(const std::filesystem::path& path, const EstimateColumns& columns)
    : file_(path), columns_(columns) {
  file_.write(
      "time_s,fx_tip_N,fy_tip_N,fz_tip_N,sigma_x_N,sigma_y_N,sigma_z_N,cov_xy_N2,cov_xz_N2,cov_yz_N2,"
      "fx_base_N,fy_base_N,fz_base_N,status,sensors_used,nis,dof,evaluations");
  if (columns_.stiffness) file_.write(",EI1_Nm2,sigma_EI1_Nm2,EI2_Nm2,sigma_EI2_Nm2");
  if (columns_.torsion) file_.write(",GJ_Nm2,sigma_GJ_Nm2");
  if (columns_.precurvature) file_.write(",k1_0_per_m,sigma_k1_0_per_m,k2_0_per_m,sigma_k2_0_per_m");
  if (columns_.forecast)
    file_.write(
        ",forecast_fx_tip_N,forecast_fy_tip_N,forecast_fz_tip_N,forecast_sigma_x_N,forecast_sigma_y_N,"
        "forecast_sigma_z_N");
  file_.write("\n");
}

namespace {

/// `count` of the values from `first` on, each followed by its sigma.
std::string with_sigmas(const Vector3d& values, const Vector3d& sigmas, int first, int count) {
  std::string text;
  for (int i = first; i < first + count; ++i) text += fmt::format(",{:.9g},{:.9g}", values(i), sigmas(i));
  return text;
}

}  // namespace

void EstimateCsvWriter::write(const Estimate& e) {
  const Vector3d &f = e.force_tip_N, &b = e.force_base_N;
  const Matrix3d& P = e.covariance_tip_N2;
  const Vector3d sigma = P.diagonal().cwiseSqrt();
  file_.write(fmt::format(
      "{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{},{},{:.6g},{},{}",
      e.time_s, f.x(), f.y(), f.z(), sigma.x(), sigma.y(), sigma.z(), P(0, 1), P(0, 2), P(1, 2), b.x(), b.y(), b.z(),
      describe(e.status), e.sensors_used, e.nis, e.dof, e.evaluations));
  const ShaftEstimate& shaft = e.shaft;
  if (columns_.stiffness) file_.write(with_sigmas(shaft.stiffness_Nm2, shaft.stiffness_sigma_Nm2, 0, 2));
  if (columns_.torsion) file_.write(with_sigmas(shaft.stiffness_Nm2, shaft.stiffness_sigma_Nm2, 2, 1));
  if (columns_.precurvature) file_.write(with_sigmas(shaft.precurvature_per_m, shaft.precurvature_sigma_per_m, 0, 2));
  if (columns_.forecast) {
    const Vector3d &ahead = e.forecast.mean_N, ahead_sigma = e.forecast.covariance_N2.diagonal().cwiseSqrt();
    file_.write(fmt::format(",{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}", ahead.x(), ahead.y(), ahead.z(),
                            ahead_sigma.x(), ahead_sigma.y(), ahead_sigma.z()));
  }
  file_.write("\n");
}

namespace {

std::optional<EstimateStatus> parse_status(std::string_view text) {
  for (std::size_t i = 0; i < kEstimateStatuses; ++i)
    if (text == describe(static_cast<EstimateStatus>(i))) return static_cast<EstimateStatus>(i);
  return std::nullopt;
}

/// What an estimate CSV may have beside what is needed to judge it.
class ExtraColumns {
 public:
  explicit ExtraColumns(const CsvReader& csv) : csv_(csv) {
    for (std::size_t i = 0; i < kNames.size(); ++i) column_[i] = csv.find(kNames[i]);
  }
  void read(EstimateRow& row) const {
    const auto number = [&](std::size_t i, auto& out) {
      if (column_[i]) out = static_cast<std::remove_reference_t<decltype(out)>>(csv_.finite_number(*column_[i]));
    };
    if (column_[0]) row.sensors_used = static_cast<int>(csv_.integer(*column_[0]));
    number(1, row.nis);
    if (column_[2]) row.dof = static_cast<int>(csv_.integer(*column_[2]));
    for (int axis = 0; axis < 3; ++axis) number(static_cast<std::size_t>(3 + axis), row.shaft.stiffness_Nm2(axis));
    for (int axis = 0; axis < 2; ++axis) number(static_cast<std::size_t>(6 + axis), row.shaft.precurvature_per_m(axis));
  }

 private:
  static constexpr std::array<std::string_view, 8> kNames{"sensors_used", "nis",    "dof",        "EI1_Nm2",
                                                          "EI2_Nm2",      "GJ_Nm2", "k1_0_per_m", "k2_0_per_m"};
  const CsvReader& csv_;
  std::array<std::optional<std::size_t>, kNames.size()> column_{};
};

}  // namespace

EstimateRow row_of(const Estimate& e) {
  EstimateRow row{.time_s = e.time_s, .force_tip_N = e.force_tip_N, .covariance_tip_N2 = e.covariance_tip_N2};
  row.status = e.status;
  row.sensors_used = e.sensors_used;
  row.nis = e.nis;
  row.dof = e.dof;
  row.shaft = e.shaft;
  return row;
}

std::vector<EstimateRow> read_estimate_csv(const std::filesystem::path& path) {
  const TextFile file = read_text_file(path);
  CsvReader csv(file);
  constexpr std::array<std::string_view, 10> names{"time_s",    "fx_tip_N",  "fy_tip_N",  "fz_tip_N",  "sigma_x_N",
                                                   "sigma_y_N", "sigma_z_N", "cov_xy_N2", "cov_xz_N2", "cov_yz_N2"};
  std::array<std::size_t, 10> column{};
  for (std::size_t i = 0; i < names.size(); ++i) column[i] = csv.require(names[i]);
  const std::size_t status_column = csv.require("status");

  const ExtraColumns extra(csv);
  std::vector<EstimateRow> rows;
  while (csv.next()) {
    std::array<double, 10> v{};
    for (std::size_t i = 1; i < v.size(); ++i) v[i] = csv.finite_number(column[i]);
    v[0] = csv.number(column[0]);  // a frame's own time, whatever the tracker made of it
    const auto status = parse_status(csv.text(status_column));
    if (!status) csv.refuse(status_column, "UPDATED, RESEEDED, AMBIGUOUS, REJECTED, HELD, NOT_CONVERGED or STALE");
    EstimateRow row{.time_s = v[0], .force_tip_N = {v[1], v[2], v[3]}, .status = *status};
    row.covariance_tip_N2 << v[4] * v[4], v[7], v[8], v[7], v[5] * v[5], v[9], v[8], v[9], v[6] * v[6];
    extra.read(row);
    row.line = csv.line();
    rows.push_back(row);
  }
  return rows;
}

}  // namespace palpate
