// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/simulation/situation.hpp>

namespace palpate {

/// What the load does to a contact point at one place, in the room.
struct ContactForce {
  Vector3d force_room_N = Vector3d::Zero();
  Matrix3d by_place_N_per_m = Matrix3d::Zero();  ///< d force / d place
  bool touches = false;
};

/// Where friction holds the contact point: the springs between it and this place of the wall. Nothing while the wall
/// is not touched.
using Anchor = std::optional<Vector3d>;

/// Where the contact point is, and what is known of the shaft behind it.
struct Place {
  Vector3d place_room_m = Vector3d::Zero();
  Vector3d borne_room_N = Vector3d::Zero();  ///< force that the shaft bears there, in balance with the load or not
  double compliance_m_per_N = 0.0;           ///< of the shaft against a force across its tip, L^3 / (3 EI): a scale
};

/// Force of the load on a contact point at `place_room_m`, with its derivative:
///
///   ForceLoad   F                                            (as it stands; in the tip's components if it says so)
///   PulleyLoad  m g (q - p) / |q - p|
///   WallLoad    k d n + F_t,  d = (w - p).n > 0;  F_t = -k_t t,  t = (I - n n^T)(p - anchor),
///               and -mu k d t / |t| where that is less
///
/// g = 9.80665 m/s^2. Throws InputError where the contact point has reached the pulley.
///
/// Whether the wall touches, and whether friction holds, is decided by the force that the law gives, mixed with the one
/// that the shaft bears at present: (1 - w) F + w F_law, w = 1 / (1 + k c) with the shaft's compliance c. Where the two
/// are equal this changes nothing; on the way there Newton's method no longer hops on and off a stiff wall, in whose
/// law a hair's breadth is a large force (the active set of an augmented Lagrangian).
ContactForce contact_force(const Load& load, const Situation& situation, const Anchor& anchor, const Place& at);

/// The anchor once the contact point has come to rest at `place_room_m`: set where contact begins, dragged along where
/// friction slips (return mapping), gone without contact.
Anchor next_anchor(const Load& load, const Situation& situation, const Anchor& anchor, const Vector3d& place_room_m);

/// The wall's own point, moved along its normal to where the wall is now.
Vector3d wall_point_room_m(const WallLoad& wall, const Situation& situation);

/// How deep the place lies in the wall [m]; negative: outside.
double wall_depth_m(const WallLoad& wall, const Situation& situation, const Vector3d& place_room_m);

}  // namespace palpate
