// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <palpate/math/errors.hpp>
#include <palpate/recording/load_points.hpp>
#include <palpate/recording/nearest_name.hpp>

namespace palpate {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<std::string_view, 11> kColumns = {
    "arc_length_mm", "x_mm", "y_mm", "z_mm", "q0", "qx", "qy", "qz", "sigma_mm", "sigma_deg", "case"};
constexpr std::array<std::string_view, 3> kAxes = {"x_mm", "y_mm", "z_mm"};
constexpr std::array<std::string_view, 4> kQuaternion = {"q0", "qx", "qy", "qz"};

/// The points of one case, row by row.
class PointReader {
 public:
  PointReader(const TextFile& file, const Catheter& catheter, const LoadPointOptions& options)
      : file_(file), catheter_(catheter), options_(options), csv_(file) {
    check_columns();
    shaft_m_ = catheter.rod.length_m() + catheter.rod.rigid_tip_m;
  }

  std::vector<LoadPoint> read() {
    const auto name = csv_.find("case");
    std::vector<LoadPoint> points;
    while (csv_.next())
      if (!name || csv_.text(*name) == options_.case_name) points.push_back(point());
    if (points.empty()) refuse_no_rows(name.has_value());
    check_sigmas(points);
    refuse_metres(points);
    return points;
  }

 private:
  void check_columns() const {
    const auto refuse = [this](std::string_view value, std::string_view expectation) {
      refuse_field(file_.name, csv_.line(), "header", value, expectation);
    };
    for (const std::string_view column : csv_.columns()) {
      if (std::find(kColumns.begin(), kColumns.end(), column) != kColumns.end()) continue;
      refuse(column, fmt::format("a known column; did you mean {}?", nearest_name(column, kColumns)));
    }
    const auto absent = [this](std::string_view column) { return !csv_.find(column); };
    const std::string& header = file_.lines[csv_.line() - 1];
    if (std::all_of(kAxes.begin(), kAxes.end(), absent)) refuse(header, "at least one of x_mm, y_mm, z_mm");
    const auto missing = std::count_if(kQuaternion.begin(), kQuaternion.end(), absent);
    if (missing != 0 && missing != 4) refuse(header, "q0, qx, qy and qz, or none of them");
  }

  [[noreturn]] void refuse_no_rows(bool by_case) const {
    if (!by_case) refuse_field(file_.name, csv_.line(), "row", "", "at least one point after the header");
    refuse_field(file_.name, csv_.line(), "case", options_.case_name, "a row of this case");
  }

  [[noreturn]] void refuse(std::string_view column, std::string_view expectation) const {
    if (const auto found = csv_.find(column)) csv_.refuse(*found, expectation);
    refuse_field(file_.name, csv_.line(), column, "", expectation);
  }

  double value(std::string_view column) const {
    const auto found = csv_.find(column);
    return !found || csv_.text(*found).empty() ? kNaN : csv_.finite_number(*found);
  }

  LoadPoint point() const {
    LoadPoint point;
    point.line = csv_.line();
    point.arc_length_m = value("arc_length_mm") * kMetresPerMillimetre;
    for (int axis = 0; axis < 3; ++axis)
      point.position_base_m(axis) = value(kAxes[static_cast<std::size_t>(axis)]) * kMetresPerMillimetre;
    point.R_base_local = orientation();
    read_sigmas(point);
    if (options_.in_tracker_frame) turn_into_base(point);
    check_place(point);
    check_reach(point);
    return point;
  }

  std::optional<Matrix3d> orientation() const {
    Eigen::Vector4d q;
    for (int i = 0; i < 4; ++i) q(i) = value(kQuaternion[static_cast<std::size_t>(i)]);
    if (q.array().isNaN().all()) return std::nullopt;
    for (std::size_t i = 0; i < 4; ++i)
      if (std::isnan(q(static_cast<int>(i)))) refuse(kQuaternion[i], "a number, for the quaternion's others are given");
    if (std::abs(q.norm() - 1.0) > 0.01) refuse("q0", fmt::format("a unit quaternion, here of norm {:.6g}", q.norm()));
    return Eigen::Quaterniond(q(0), q(1), q(2), q(3)).normalized().toRotationMatrix();
  }

  void read_sigmas(LoadPoint& point) const {
    const auto sigma = [this](std::string_view column, double most, std::string_view expectation) {
      const double found = value(column);
      if (found <= 0.0 || found > most) refuse(column, expectation);
      return std::isnan(found) ? 0.0 : found;
    };
    point.sigma_m = sigma("sigma_mm", 1e3, "a standard deviation in mm, more than 0") * kMetresPerMillimetre;
    point.sigma_rad =
        sigma("sigma_deg", 90.0, "a standard deviation in degrees, more than 0, at most 90") * kRadiansPerDegree;
    if (!point.R_base_local) return;
    if (point.sigma_rad == 0.0) refuse("sigma_deg", "a standard deviation in degrees, for there is a quaternion");
    if (point.sigma_m == 0.0) refuse("sigma_mm", "a standard deviation in mm, for there is a quaternion");
  }

  void turn_into_base(LoadPoint& point) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (std::isnan(point.position_base_m(static_cast<int>(axis))))
        refuse(kAxes[axis], "a number in mm, for frame = \"tracker\" needs all three");
    const Pose T_base_tracker = catheter_.base.T_tracker_base.inverse();
    point.position_base_m = T_base_tracker * point.position_base_m;
    if (point.R_base_local) point.R_base_local = T_base_tracker.R * *point.R_base_local;
  }

  void check_place(const LoadPoint& point) const {
    if (point.position_base_m.array().isNaN().all() && !point.R_base_local)
      refuse_field(file_.name, csv_.line(), "row", file_.lines[csv_.line() - 1],
                   "at least one of x_mm, y_mm, z_mm to be a number");
    if (std::isnan(point.arc_length_m)) {
      if (point.R_base_local) refuse("arc_length_mm", "the arc length in mm, for there is a quaternion");
      if (std::isnan(point.position_base_m.z())) refuse("arc_length_mm", "the arc length in mm, for there is no z_mm");
    } else if (!(point.arc_length_m >= 0.0 && point.arc_length_m <= shaft_m_ + 1e-9)) {
      refuse("arc_length_mm",
             fmt::format("0..{:.6g} mm, the shaft with its rigid tip", shaft_m_ * kMillimetresPerMetre));
    }
  }

  /// No point of a clamped shaft is much farther from the clamp than the shaft is long.
  void check_reach(const LoadPoint& point) const {
    const double reach_m = 1.5 * shaft_m_ + 0.02 + 4.0 * catheter_.base.position_sigma_m;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double place_m = point.position_base_m(static_cast<int>(axis));
      if (std::isnan(place_m) || std::abs(place_m) <= reach_m) continue;
      refuse(kAxes[axis],
             fmt::format("millimetres, a point at most {:.4g} mm from the clamp of a shaft of {:.4g} mm{}",
                         reach_m * kMillimetresPerMetre, shaft_m_ * kMillimetresPerMetre,
                         options_.in_tracker_frame ? fmt::format(", here {:.4g} mm along {} of the base",
                                                                 place_m * kMillimetresPerMetre, "xyz"[axis])
                                                   : ""));
    }
  }

  void check_sigmas(const std::vector<LoadPoint>& points) const {
    const bool stated = points.front().sigma_m > 0.0;
    for (const LoadPoint& point : points)
      if ((point.sigma_m > 0.0) != stated)
        refuse_field(file_.name, point.line, "sigma_mm", point.sigma_m > 0.0 ? "a number" : "",
                     "a standard deviation in every row, or in none");
  }

  /// A shaft of which nothing is seen beyond its first fiftieth was measured in another unit.
  void refuse_metres(const std::vector<LoadPoint>& points) const {
    double farthest_m = 0.0;
    for (const LoadPoint& point : points) {
      if (!std::isnan(point.arc_length_m)) farthest_m = std::max(farthest_m, point.arc_length_m);
      for (const double place_m : point.position_base_m)
        if (!std::isnan(place_m)) farthest_m = std::max(farthest_m, std::abs(place_m));
    }
    if (farthest_m >= 0.02 * shaft_m_) return;
    const bool by_arc = !std::isnan(points.back().arc_length_m);
    const double last_m = by_arc ? points.back().arc_length_m : points.back().position_base_m.z();
    refuse_field(file_.name, points.back().line, by_arc ? "arc_length_mm" : "z_mm",
                 fmt::format("{:.6g}", last_m * kMillimetresPerMetre),
                 fmt::format("millimetres: no point is farther than {:.3g} mm along a shaft of {:.4g} mm; are they in "
                             "metres?",
                             farthest_m * kMillimetresPerMetre, shaft_m_ * kMillimetresPerMetre));
  }

  const TextFile& file_;
  const Catheter& catheter_;
  const LoadPointOptions& options_;
  CsvReader csv_;
  double shaft_m_ = 0.0;
};

}  // namespace

std::vector<LoadPoint> parse_load_points(const TextFile& file, const Catheter& catheter,
                                         const LoadPointOptions& options) {
  return PointReader(file, catheter, options).read();
}

}  // namespace palpate
