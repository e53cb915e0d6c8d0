// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/rod/base_loads.hpp>
#include <palpate/simulation/contact_force.hpp>

/// The loop that a load which knows its place closes around the fast path. Under a tip force F (tip components, the
/// flow f included) the shaft has one shape; the load, a function of where the contact point p then is, must be F:
///
///   g(F) = F - f - R_room_tip(F)^T F_room(p(F)) = 0,   dg/dF = I - hat(R^T F_room) Phi - R^T (dF_room/dp) P
///
/// with Phi = d(body rotation of the tip)/dF and P = dp/dF from the fast path: exact.
namespace palpate {

/// Shape and load at one tip force, whether in balance or not.
struct Balance {
  Vector3d force_tip_N = Vector3d::Zero();  ///< F
  Vector3d excess_N = Vector3d::Zero();     ///< g
  Matrix3d excess_by_force = Matrix3d::Identity();
  Matrix3d turn_by_force_per_N = Matrix3d::Zero();     ///< Phi
  Matrix3d place_by_force_m_per_N = Matrix3d::Zero();  ///< P, room
  Vector3d place_room_m = Vector3d::Zero();            ///< p
  Pose T_room_tip;                                     ///< flexible end
  ContactForce contact;
  Vector3d contact_tip_N = Vector3d::Zero();  ///< of the load alone
  /// No eigenvalue of d moment / d rotation of the tip, the load answering, is negative: on a path from rest along
  /// which this holds the potential energy has a minimum. Without meaning where g is not 0.
  bool stable = true;
};

class LoadedShaft {
 public:
  /// Keeps references to both.
  LoadedShaft(const Catheter& catheter, const Load& load);

  /// False: no shape under the rod's own weight was found. One integration with six sensitivities without own weight.
  bool balance(const Situation& situation, const Anchor& anchor, const Vector3d& force_tip_N, Balance& out);

  /// Of the last balance: stations as Catheter::sensors, then the flexible end.
  const RodSolution<6>& shape() const { return shape_; }
  const Load& load() const { return load_; }

  /// The load turns with the tip: g does not know the shape, and F is given.
  bool load_in_tip() const;
  double force_scale_N() const { return force_scale_N_; }  ///< EI / L^2, the least EI: on which shapes change
  double compliance_m_per_N() const { return length_m() / (3.0 * force_scale_N_); }  ///< L^3 / (3 EI), likewise
  double length_m() const { return catheter_.rod.length_m(); }

 private:
  void turn_weight(double twist_rad);
  bool is_stable(const Balance& at, const Matrix3d& load_by_turn, const Matrix3d& load_by_moment) const;

  const Catheter& catheter_;
  const Load& load_;
  std::vector<double> arc_lengths_m_;
  std::optional<RodSolver> solver_;
  double solver_twist_rad_ = 0.0;
  WeightWorkspace<6> workspace_;
  LoadDirections<6> directions_;
  RodSolution<6> shape_;
  double force_scale_N_ = 0.0;
};

}  // namespace palpate
