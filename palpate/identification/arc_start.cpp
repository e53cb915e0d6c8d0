// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <palpate/identification/arc_start.hpp>
#include <palpate/math/errors.hpp>
#include <palpate/math/units.hpp>

namespace palpate {

namespace {

/// Neighbours along the shaft: the chord is no longer than the arc, and not much shorter either.
void check_distances(const std::vector<ShaftPoint>& points, const std::array<bool, 3>& measured, double sigma_m) {
  std::vector<ShaftPoint> sorted = points;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const ShaftPoint& a, const ShaftPoint& b) { return a.arc_length_m < b.arc_length_m; });
  const double tolerance_m = std::max(1e-3, 6.0 * sigma_m);
  double chords_m = 0.0, arcs_m = 0.0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const double arc_m = sorted[i].arc_length_m - sorted[i - 1].arc_length_m;
    if (arc_m == 0.0) continue;
    Vector3d chord = sorted[i].position_m - sorted[i - 1].position_m;
    for (int axis = 0; axis < 3; ++axis)
      if (!measured[static_cast<std::size_t>(axis)]) chord(axis) = 0.0;
    arcs_m += arc_m;
    chords_m += chord.norm();
    if (chord.norm() > 1.02 * arc_m + tolerance_m)
      throw InputError(fmt::format(
          "points at arc lengths {:.6g} and {:.6g} mm: {:.4g} mm apart: expected at most the arc between them, {:.4g} "
          "mm{}",
          sorted[i - 1].arc_length_m * kMillimetresPerMetre, sorted[i].arc_length_m * kMillimetresPerMetre,
          chord.norm() * kMillimetresPerMetre, arc_m * kMillimetresPerMetre,
          chord.norm() > 100.0 * arc_m ? " (are the arc lengths in metres?)" : ""));
  }
  if (chords_m < 0.25 * arcs_m)
    throw InputError(
        fmt::format("points: {:.4g} mm along their chords, {:.4g} mm along the shaft: expected distances that fit the "
                    "arc lengths{}",
                    chords_m * kMillimetresPerMetre, arcs_m * kMillimetresPerMetre,
                    chords_m < 0.01 * arcs_m ? " (are the positions in metres?)" : ""));
}

/// Curvature of an arc of length s under a chord c: c = sin(k s / 2) / (k / 2).
double curvature_of_chord(double chord_m, double arc_m) {
  if (!(chord_m < arc_m)) return 0.0;
  double low = 0.0, high = std::numbers::pi;
  for (int i = 0; i < 60; ++i) {
    const double half = 0.5 * (low + high);
    (std::sin(half) / half > chord_m / arc_m ? low : high) = half;
  }
  return 2.0 * low / arc_m;
}

/// Rotation and translation of the measured components that lay `from` onto `to`, both 3 x n.
Pose laid_onto(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to, const std::array<bool, 3>& measured) {
  std::vector<int> axes;
  for (int axis = 0; axis < 3; ++axis)
    if (measured[static_cast<std::size_t>(axis)]) axes.push_back(axis);
  const Eigen::MatrixXd T =
      Eigen::umeyama(Eigen::MatrixXd(from(axes, Eigen::all)), Eigen::MatrixXd(to(axes, Eigen::all)), false);
  const auto n = static_cast<Eigen::Index>(axes.size());
  Pose out;
  for (Eigen::Index i = 0; i < n; ++i) {
    out.p(axes[static_cast<std::size_t>(i)]) = T(i, n);
    for (Eigen::Index j = 0; j < n; ++j)
      out.R(axes[static_cast<std::size_t>(i)], axes[static_cast<std::size_t>(j)]) = T(i, j);
  }
  return out;
}

double misfit(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to, const Pose& T,
              const std::array<bool, 3>& measured) {
  const Eigen::Matrix3Xd error = to - ((T.R * from).colwise() + T.p);
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis)
    if (measured[static_cast<std::size_t>(axis)]) sum += error.row(axis).squaredNorm();
  return sum;
}

}  // namespace

std::array<bool, 3> check_points(const Catheter& catheter, const ArcData& data) {
  std::array<bool, 3> measured{true, true, true};
  if (data.points.empty()) return measured;
  const double end_m = catheter.rod.length_m() + catheter.rod.rigid_tip_m;
  for (std::size_t axis = 0; axis < 3; ++axis)
    measured[axis] = std::isfinite(data.points[0].position_m(static_cast<Eigen::Index>(axis)));
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const ShaftPoint& point = data.points[i];
    if (!(point.arc_length_m >= 0.0 && point.arc_length_m <= end_m * (1.0 + 1e-9)))
      throw InputError(fmt::format("point {}: arc length = {:.6g} mm: expected 0..{:.6g} mm, the shaft with its tip",
                                   i + 1, point.arc_length_m * kMillimetresPerMetre, end_m * kMillimetresPerMetre));
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (std::isfinite(point.position_m(static_cast<Eigen::Index>(axis))) != measured[axis])
        throw InputError(fmt::format("point {}: expected the same components as those of the first point", i + 1));
  }
  if (!measured[2] && !(measured[0] || measured[1]))
    throw InputError("points: expected the measured components x, y, z, or z with x or y, or x, or y");
  if (measured[2]) check_distances(data.points, measured, data.point_sigma_m);
  return measured;
}

std::vector<ArcObservation> observations_of(const Catheter& catheter, const ArcData& data) {
  std::vector<ArcObservation> out;
  for (const ShaftPoint& point : data.points) {
    ArcObservation& seen = out.emplace_back();
    seen.sensor.kind = SensorKind::kPosition;
    seen.sensor.arc_length_m = std::min(point.arc_length_m, catheter.rod.length_m() + catheter.rod.rigid_tip_m);
    seen.measured.p = point.position_m;
  }
  for (std::size_t i = 0; i < data.poses.size(); ++i) {
    const Sensor& sensor = catheter.sensors[i];
    const MeanPose& pose = data.poses[i];
    if (pose.count == 0) continue;
    if (!(pose.T_base_sensor.p.norm() < 100.0))
      throw InputError(fmt::format("sensor \"{}\": {:.3g} m from the base: expected places of this catheter",
                                   sensor.name, pose.T_base_sensor.p.norm()));
    const Vector3d white = sensor.noise_m / std::sqrt(pose.count);
    const double lasting = sensor.bias_m * sensor.bias_m / 3.0 + sensor.mount_sigma_m * sensor.mount_sigma_m;
    out.push_back({sensor, pose.T_base_sensor, (white.cwiseAbs2().array() + lasting).sqrt(),
                   std::hypot(sensor.noise_rad / std::sqrt(pose.count), sensor.bias_rad / std::sqrt(3.0))});
  }
  return out;
}

Eigen::Vector2d kept_direction(const Catheter& catheter, const std::array<bool, 3>& measured) {
  if (!measured[0]) return Eigen::Vector2d::UnitX();
  if (!measured[1]) return Eigen::Vector2d::UnitY();
  const Eigen::Vector2d k = catheter.precurvature_per_m().head<2>();
  return k.norm() > 1e-9 ? k.normalized() : Eigen::Vector2d::UnitX();
}

ArcStart start_of(const Catheter& catheter, const ArcModel& model, const std::array<bool, 3>& measured,
                  ClampKnowledge clamp) {
  const Vector3d& described = catheter.precurvature_per_m();
  const std::vector<ArcObservation>& seen = model.observations();
  if (clamp != ClampKnowledge::kFree) return {described, {}};
  for (const ArcObservation& one : seen) {
    if (one.sensor.kind != SensorKind::kPose) continue;
    const ArcVector x = (ArcVector() << described, 0, 0, 0, 0, 0, 0).finished();
    const auto index = static_cast<std::size_t>(&one - seen.data());
    return {described, one.measured * model.poses(x)[index].inverse()};
  }
  Eigen::Matrix3Xd to(3, seen.size());
  for (std::size_t i = 0; i < seen.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      to(axis, static_cast<Eigen::Index>(i)) =
          measured[static_cast<std::size_t>(axis)] ? seen[i].measured.p(axis) : 0.0;
  const auto [first, last] = std::minmax_element(seen.begin(), seen.end(), [](const auto& a, const auto& b) {
    return a.sensor.arc_length_m < b.sensor.arc_length_m;
  });
  const double k = curvature_of_chord((to.col(last - seen.begin()) - to.col(first - seen.begin())).norm(),
                                      last->sensor.arc_length_m - first->sensor.arc_length_m);
  const Eigen::Vector2d direction = kept_direction(catheter, measured);
  ArcStart best;
  double least = std::numeric_limits<double>::infinity();
  const bool flat = !measured[0] || !measured[1];  // otherwise the clamp turns by half a turn, and -k is k
  for (const double kappa : {k, flat ? -k : k, direction.dot(described.head<2>())}) {
    Vector3d bend = described;
    bend.head<2>() = kappa * direction;
    const std::vector<Pose> poses = model.poses((ArcVector() << bend, 0, 0, 0, 0, 0, 0).finished());
    Eigen::Matrix3Xd from(3, seen.size());
    for (std::size_t i = 0; i < seen.size(); ++i) from.col(static_cast<Eigen::Index>(i)) = poses[i].p;
    const Pose T = laid_onto(from, to, measured);
    const double cost = misfit(from, to, T, measured);
    if (cost >= least) continue;
    least = cost;
    best = {bend, T};
  }
  return best;
}

std::vector<ArcVector> arc_starts(ArcModel& model, const Eigen::Matrix<double, 9, Eigen::Dynamic>& M,
                                  const Vector3d& stated_per_m, double length_m) {
  constexpr int kDirections = 8, kSizes = 8, kTried = 4;
  constexpr double kSizeStep_rad = 0.7;
  std::vector<std::pair<double, ArcVector>> found;
  const auto consider = [&](const Vector3d& bend) {
    ArcVector x = ArcVector::Zero();
    x.head<3>() = bend;
    model.set_unknowns(x, M);
    Eigen::VectorXd r;
    if (model.evaluate(Eigen::VectorXd::Zero(model.unknowns()), r, nullptr)) found.emplace_back(r.squaredNorm(), x);
  };
  for (int size = 0; size <= kSizes; ++size)
    for (int i = 0; i < (size == 0 ? 1 : kDirections); ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kDirections, k = kSizeStep_rad * size / length_m;
      Vector3d bend = stated_per_m;
      if (M.row(0).any()) bend.x() = k * std::cos(angle);
      if (M.row(1).any()) bend.y() = k * std::sin(angle);
      consider(bend);
    }
  const auto less = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::sort(found.begin(), found.end(), less);
  found.resize(std::min<std::size_t>(found.size(), kTried));
  consider(stated_per_m);
  std::vector<ArcVector> starts;
  starts.reserve(found.size());
  for (const auto& [cost, x] : found) starts.push_back(x);
  return starts;
}

}  // namespace palpate
