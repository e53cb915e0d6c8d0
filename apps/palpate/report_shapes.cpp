// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <palpate/evaluation/shown_shape.hpp>
#include <palpate/observer/observability.hpp>
#include <palpate/sensing/measurement.hpp>

#include "report_json.hpp"

namespace palpate::app {

namespace {

constexpr std::size_t kMostMoments = 400;  // all frames are shown up to here
constexpr int kBins = 200;                 // beyond, least and greatest force of each of them
constexpr int kPoints = 21;                // along the shaft

nlohmann::json numbers(const Eigen::Ref<const Eigen::MatrixXd>& values, double scale, int digits) {
  nlohmann::json out = nlohmann::json::array();
  for (Eigen::Index column = 0; column < values.cols(); ++column)
    for (Eigen::Index row = 0; row < values.rows(); ++row) out.push_back(rounded(scale * values(row, column), digits));
  return out;
}

/// Micrometres as whole numbers would be longer than millimetres with two decimals.
nlohmann::json millimetres(const Vector3d& p_m) {
  nlohmann::json out = nlohmann::json::array();
  for (int i = 0; i < 3; ++i) {
    const double value = std::round(p_m(i) * kMillimetresPerMetre * 100.0) / 100.0;
    out.push_back(std::isfinite(value) ? nlohmann::json(value) : nlohmann::json());
  }
  return out;
}

/// Where each sensor was seen, in the base frame; null where it was not.
nlohmann::json seen_sensors(const Catheter& catheter, const TrackerFrame& frame) {
  Measurement measurement;
  register_frame(catheter, frame, measurement);
  nlohmann::json out = nlohmann::json::array();
  for (std::size_t i = 0; i < catheter.sensors.size(); ++i) out.push_back(nullptr);
  for (int i = 0; i < measurement.count; ++i)
    out[static_cast<std::size_t>(measurement.poses[i].sensor)] = millimetres(measurement.poses[i].T_base_sensor.p);
  return out;
}

/// Semi-axes of the 95 % ellipsoid as columns, base components.
Matrix3d ellipsoid_base_N(const Matrix3d& R_base_tip, const Matrix3d& covariance_tip_N2) {
  const ForceEllipsoid ellipsoid = force_ellipsoid(covariance_tip_N2);
  return R_base_tip * ellipsoid.axes * ellipsoid.semi_axes_N.asDiagonal();
}

std::vector<std::size_t> choose_moments(const ReportRun& run) {
  std::vector<double> size_N;
  for (const ForceSize& size : run.sizes)
    size_N.push_back(size.measured ? size.size_N : std::numeric_limits<double>::quiet_NaN());
  std::vector<std::size_t> chosen = telling_rows(run.rows.size(), {size_N}, kMostMoments, kBins);
  std::erase_if(chosen, [&](std::size_t i) { return !std::isfinite(run.rows[i].time_s); });
  return chosen;
}

nlohmann::json moment_json(const ReportRun& run, std::size_t i, ShownShape& drawer) {
  const EstimateRow& row = run.rows[i];
  const RodSolution<3>& solution = drawer.solve(run.frames[i], row);
  nlohmann::json shaft = nlohmann::json::array(), sensors = nlohmann::json::array();
  for (std::size_t k = 0; k < solution.points.size(); ++k)
    for (nlohmann::json& value : millimetres(solution.points[k].T_base_local.p))
      (k < kPoints ? shaft : sensors).push_back(std::move(value));
  const Matrix3d& R = solution.T_base_tip.R;
  const Pose& tip = solution.T_base_tip;
  return {{"t", rounded(row.time_s, 9)},
          {"shaft", std::move(shaft)},
          {"sensors", std::move(sensors)},
          {"seen", seen_sensors(run.catheter, run.frames[i])},
          {"contact", millimetres(tip * run.catheter.rod.contact_offset_m)},
          {"R", numbers(R, 1.0, 4)},
          {"force", numbers(R * row.force_tip_N, 1.0, 4)},
          {"ellipsoid", numbers(ellipsoid_base_N(R, row.covariance_tip_N2), 1.0, 3)},
          {"status", static_cast<int>(row.status)}};
}

}  // namespace

nlohmann::json shapes_json(const ReportRun& run) {
  ShownShape drawer(run.catheter, kPoints);
  nlohmann::json moments = nlohmann::json::array();
  for (const std::size_t i : choose_moments(run)) moments.push_back(moment_json(run, i, drawer));
  nlohmann::json names = nlohmann::json::array();
  for (const Sensor& sensor : run.catheter.sensors) names.push_back(sensor.name);
  const double length_m = run.catheter.rod.length_m() + run.catheter.rod.rigid_tip_m;
  return {{"length_mm", rounded(length_m * kMillimetresPerMetre, 6)},
          {"rigid_tip_mm", rounded(run.catheter.rod.rigid_tip_m * kMillimetresPerMetre, 6)},
          {"sensors", std::move(names)},
          {"moments", std::move(moments)}};
}

}  // namespace palpate::app
