// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/math/errors.hpp>
#include <palpate/simulation/contact_force.hpp>

namespace palpate {

namespace {

constexpr double kGravity_m_per_s2 = 9.80665;

ContactForce force_of(const ForceLoad&, const Situation& situation, const Anchor&, const Place&) {
  return {.force_room_N = situation.force_N, .touches = !situation.force_N.isZero(0.0)};
}

ContactForce force_of(const PulleyLoad& pulley, const Situation& situation, const Anchor&, const Place& at) {
  const Vector3d thread = situation.pulley_m - at.place_room_m;
  const double length_m = thread.norm();
  if (!(length_m > 1e-6))
    throw InputError(
        fmt::format("load.pulley_base_m = [{:.6g}, {:.6g}, {:.6g}]: expected a place off the contact point",
                    situation.pulley_m.x(), situation.pulley_m.y(), situation.pulley_m.z()));
  const Vector3d along = thread / length_m;
  const double weight_N = pulley.mass_kg * kGravity_m_per_s2;
  return {.force_room_N = weight_N * along,
          .by_place_N_per_m = -weight_N / length_m * (Matrix3d::Identity() - along * along.transpose()),
          .touches = weight_N > 0.0};
}

Vector3d along_wall(const Vector3d& n, const Vector3d& shift) { return shift - n * n.dot(shift); }

/// Share of the law's force in the decision; the rest is what the shaft bears.
double law_share(double stiffness_N_per_m, const Place& at) {
  return 1.0 / (1.0 + stiffness_N_per_m * at.compliance_m_per_N);
}

/// Friction, added to a touching wall's normal force of the size `normal_N`.
void add_friction(const WallLoad& wall, const Vector3d& anchor, const Place& at, double normal_N, double decisive_N,
                  ContactForce& contact) {
  const double k = wall.stiffness_N_per_m, k_t = wall.tangential_stiffness_N_per_m, w = law_share(k_t, at);
  const Vector3d n = wall.normal_base.normalized(), t = along_wall(n, at.place_room_m - anchor);
  const Matrix3d across = Matrix3d::Identity() - n * n.transpose();
  const Vector3d decisive_t_N = (1.0 - w) * along_wall(n, at.borne_room_N) - w * k_t * t;
  if (decisive_t_N.norm() <= wall.friction * decisive_N) {
    contact.force_room_N -= k_t * t;
    contact.by_place_N_per_m -= k_t * across;
    return;
  }
  if (t.isZero(0.0)) return;
  const double most_N = wall.friction * normal_N;
  const Vector3d slip = t.normalized();
  contact.force_room_N -= most_N * slip;
  contact.by_place_N_per_m += wall.friction * k * slip * n.transpose();
  contact.by_place_N_per_m -= most_N / t.norm() * (across - slip * slip.transpose());
}

ContactForce force_of(const WallLoad& wall, const Situation& situation, const Anchor& anchor, const Place& at) {
  const double k = wall.stiffness_N_per_m, w = law_share(k, at);
  const double normal_N = k * wall_depth_m(wall, situation, at.place_room_m);
  const Vector3d n = wall.normal_base.normalized();
  const double decisive_N = (1.0 - w) * n.dot(at.borne_room_N) + w * normal_N;
  if (!(decisive_N > 0.0)) return {};
  ContactForce contact{.force_room_N = normal_N * n, .by_place_N_per_m = -k * n * n.transpose(), .touches = true};
  const bool holds = anchor && wall.friction > 0.0 && wall.tangential_stiffness_N_per_m > 0.0;
  if (holds) add_friction(wall, *anchor, at, normal_N, decisive_N, contact);
  return contact;
}

}  // namespace

Vector3d wall_point_room_m(const WallLoad& wall, const Situation& situation) {
  return wall.point_base_m + situation.wall_m * wall.normal_base.normalized();
}

double wall_depth_m(const WallLoad& wall, const Situation& situation, const Vector3d& place_room_m) {
  return situation.wall_m + wall.normal_base.normalized().dot(wall.point_base_m - place_room_m);
}

ContactForce contact_force(const Load& load, const Situation& situation, const Anchor& anchor, const Place& at) {
  return std::visit([&](const auto& l) { return force_of(l, situation, anchor, at); }, load);
}

Anchor next_anchor(const Load& load, const Situation& situation, const Anchor& anchor, const Vector3d& place_room_m) {
  const auto* wall = std::get_if<WallLoad>(&load);
  if (wall == nullptr || wall->friction == 0.0 || wall->tangential_stiffness_N_per_m == 0.0) return std::nullopt;
  const double depth_m = wall_depth_m(*wall, situation, place_room_m);
  if (!(depth_m > 0.0)) return std::nullopt;
  if (!anchor) return place_room_m;
  const Vector3d t = along_wall(wall->normal_base.normalized(), place_room_m - *anchor);
  const double longest_m = wall->friction * wall->stiffness_N_per_m * depth_m / wall->tangential_stiffness_N_per_m;
  if (t.norm() <= longest_m) return anchor;
  return place_room_m - longest_m * t.normalized();
}

}  // namespace palpate
