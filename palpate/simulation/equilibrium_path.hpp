// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/simulation/loaded_shaft.hpp>
#include <vector>

namespace palpate {

/// The branch of equilibria ended or lost its stability, and the catheter went to another shape.
struct Snap {
  double share = 0.0;        ///< of the way from one situation to the next
  double force_N = 0.0;      ///< size of the load there
  bool settled = true;       ///< false: no stable equilibrium was found; the path ends
  double tip_moved_m = 0.0;  ///< by the contact point
  double tip_turned_rad = 0.0;
};

/// Follows a catheter's equilibrium while its situation changes slowly, along one branch, step by step. A step is
/// refused and halved where Newton's method does not close, where the tip ends more than 0.05 rad from the
/// extrapolation or the force changes by more than EI / L^2, and where it ends at an unstable equilibrium. Where no
/// step is short enough (1e-6 of the way; after 10 000 steps: none that is refused) the branch has ended or lost its
/// stability, and the catheter is left to a slow motion against a drag on its tip,
///
///   drag dp/dt = F_room(p) - R F,
///
/// which loses energy until it comes to rest (linearly implicit Euler steps, longer and longer).
class EquilibriumPath {
 public:
  /// Keeps references to both.
  EquilibriumPath(const Catheter& catheter, const Load& load) : shaft_(catheter, load) {}

  /// The unloaded catheter in the given situation, the contact point where nothing touches it.
  /// Throws InputError where there is none under the own weight.
  void rest(Situation situation);

  /// Along the straight way to `to`. Begins where rest() or the last call ended. After a snap that is not settled the
  /// path is of no use. Allocates.
  std::vector<Snap> follow(const Situation& to);

  const Balance& balance() const { return at_; }
  /// That of balance().
  const RodSolution<6>& shape() const { return shaft_.shape(); }
  const Situation& situation() const { return situation_; }

 private:
  bool start(const Situation& situation, double step, Balance& out);
  double closed_N() const;  ///< Newton's method has come to its end where its step is shorter
  bool correct(const Situation& situation, double step, Balance& out);
  bool settle(const Situation& situation, const Vector3d& push_N, Balance& out);
  bool relax(const Situation& situation, Anchor& anchor, Balance& state);
  Snap snap(const Situation& from, const Situation& to, double& share);
  void accept(const Situation& situation, const Balance& balance);

  LoadedShaft shaft_;
  Situation situation_;
  Anchor anchor_;
  Balance at_;
  Vector3d rate_N_ = Vector3d::Zero();  ///< change of the force over a whole way, at the last step
};

}  // namespace palpate
