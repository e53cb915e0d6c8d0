// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <palpate/identification/registration_starts.hpp>

namespace palpate {

namespace {

constexpr double kGridDistance_m = 5e-3, kGridAngle_rad = 0.2;  // how far apart neighbours of the grid may be

struct GridShape {
  Eigen::Vector2d bend_change_per_m;
  std::vector<Pose> T_base_sensor;
};

Eigen::Vector2d stated_bend(const Rod& rod) {
  const auto flexible =
      std::find_if(rod.sections.begin(), rod.sections.end(), [](const Section& section) { return !section.rigid; });
  if (flexible == rod.sections.end()) return Eigen::Vector2d::Zero();
  return flexible->precurvature_per_m.head<2>();
}

/// Shafts bent by up to 4.2 rad from clamp to tip, towards all sides.
std::vector<GridShape> bent_shafts(RegistrationModel& model, double step_rad, int directions) {
  constexpr double kMostBend_rad = 4.25;
  const Rod& rod = model.catheter().rod;
  const Eigen::Vector2d stated = stated_bend(rod);
  const RegistrationState state = model.stated();
  std::vector<GridShape> shapes;
  for (double bend_rad = 0.0; bend_rad < kMostBend_rad; bend_rad += step_rad) {
    for (int d = 0; d < (bend_rad > 0.0 ? directions : 1); ++d) {
      const double angle = 2.0 * std::numbers::pi * d / directions;
      const Eigen::Vector2d u = bend_rad / rod.length_m() * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      GridShape shape{u - stated, model.unloaded_shape({u.x() - stated.x(), u.y() - stated.y(), 0.0}, state)};
      if (!shape.T_base_sensor.empty()) shapes.push_back(std::move(shape));
    }
  }
  return shapes;
}

/// Turns of what the sensor does not measure: about its z axis, or all.
std::vector<Matrix3d> open_turns(SensorKind kind) {
  std::vector<Matrix3d> turns;
  if (kind == SensorKind::kPose) return {Matrix3d::Identity()};
  const int rolls = kind == SensorKind::kPose5 ? 12 : 8;
  const auto add_rolls = [&](const Matrix3d& R) {
    for (int k = 0; k < rolls; ++k) turns.emplace_back(R * exp_so3({0.0, 0.0, 2.0 * std::numbers::pi * k / rolls}));
  };
  if (kind == SensorKind::kPose5) {
    add_rolls(Matrix3d::Identity());
    return turns;
  }
  constexpr int kAxes = 24;  // z axes spread evenly over the sphere, along a spiral
  for (int n = 0; n < kAxes; ++n) {
    const double colatitude = std::acos(1.0 - (2.0 * n + 1.0) / kAxes);
    const double longitude = n * std::numbers::pi * (3.0 - std::sqrt(5.0));
    add_rolls(exp_so3({0.0, 0.0, longitude}) * exp_so3({0.0, colatitude, 0.0}));
  }
  return turns;
}

double misfit(SensorKind kind, const Pose& predicted, const Pose& measured) {
  const double distance = (predicted.p - measured.p).squaredNorm() / (kGridDistance_m * kGridDistance_m);
  if (kind == SensorKind::kPosition) return distance;
  // 1 - cos is half the square of a small angle, and cheap
  const double angle = kind == SensorKind::kPose5 ? 1.0 - predicted.R.col(2).dot(measured.R.col(2))
                                                  : 0.5 * (3.0 - predicted.R.cwiseProduct(measured.R).sum());
  return distance + 2.0 * angle / (kGridAngle_rad * kGridAngle_rad);
}

struct Start {
  double misfit = 0.0;
  RegistrationState state;
};

/// The best bend of the grid for every knob position, seen from this base.
Start judge(const RegistrationModel& model, const std::vector<GridShape>& shapes, const Pose& T_reference_base) {
  Start start{.state = model.stated()};
  start.state.T_reference_base = T_reference_base;
  const Pose T_base_reference = T_reference_base.inverse();
  const auto readings = model.readings();
  for (std::size_t first = 0, end = 0; first < readings.size(); first = end) {
    const int position = readings[first].position;
    std::vector<Pose> measured;
    for (; end < readings.size() && readings[end].position == position; ++end)
      measured.push_back(T_base_reference * readings[end].mean->T_base_sensor);
    double best = std::numeric_limits<double>::infinity();
    for (const GridShape& shape : shapes) {
      double sum = 0.0;
      for (std::size_t k = first; k < end && sum < best; ++k) {
        const auto i = static_cast<std::size_t>(readings[k].sensor);
        sum += misfit(model.catheter().sensors[i].kind, shape.T_base_sensor[i], measured[k - first]);
      }
      if (sum >= best) continue;
      best = sum;
      start.state.bend_change_per_m[static_cast<std::size_t>(position)] = shape.bend_change_per_m;
    }
    start.misfit += best;
  }
  return start;
}

}  // namespace

std::vector<RegistrationState> registration_starts(RegistrationModel& model, int most) {
  const auto readings = model.readings();
  const auto lead = std::max_element(readings.begin(), readings.end(),
                                     [](const auto& one, const auto& other) { return one.rows < other.rows; });
  const SensorKind kind = model.catheter().sensors[static_cast<std::size_t>(lead->sensor)].kind;
  const bool whole = kind == SensorKind::kPose;
  const std::vector<GridShape> shapes = bent_shafts(model, whole ? 0.5 : 0.6, whole ? 12 : 8);
  std::vector<Start> starts;
  for (const Matrix3d& turn : open_turns(kind)) {
    Pose T_ref_sensor = lead->mean->T_base_sensor;
    T_ref_sensor.R = kind == SensorKind::kPosition ? turn : Matrix3d(T_ref_sensor.R * turn);
    for (const GridShape& shape : shapes)
      starts.push_back(
          judge(model, shapes, T_ref_sensor * shape.T_base_sensor[static_cast<std::size_t>(lead->sensor)].inverse()));
  }
  const auto kept = std::min(starts.size(), static_cast<std::size_t>(most));
  std::partial_sort(starts.begin(), starts.begin() + static_cast<std::ptrdiff_t>(kept), starts.end(),
                    [](const Start& one, const Start& other) { return one.misfit < other.misfit; });
  std::vector<RegistrationState> best;
  for (std::size_t k = 0; k < kept; ++k) best.push_back(std::move(starts[k].state));
  return best;
}

double bend_towards_stated(const RegistrationModel& model, const RegistrationState& state) {
  const double stated = stated_bend(model.catheter().rod).x();
  double sum = 0.0;
  for (const Eigen::Vector2d& change : state.bend_change_per_m) sum += stated + change.x();
  return (stated < 0.0 ? -sum : sum) / static_cast<double>(state.bend_change_per_m.size());
}

RegistrationState rolled_half_a_turn(const RegistrationModel& model, const RegistrationState& state) {
  const Eigen::Vector2d stated = stated_bend(model.catheter().rod);
  RegistrationState rolled = state;
  rolled.T_reference_base = state.T_reference_base * Pose{exp_so3({0.0, 0.0, std::numbers::pi}), Vector3d::Zero()};
  for (Eigen::Vector2d& change : rolled.bend_change_per_m) change = -change - 2.0 * stated;
  return rolled;
}

}  // namespace palpate
