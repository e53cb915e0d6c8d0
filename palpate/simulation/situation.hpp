// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <palpate/math/pose.hpp>
#include <palpate/rod/statics.hpp>
#include <palpate/simulation/flow_force.hpp>
#include <palpate/simulation/heart.hpp>
#include <palpate/simulation/scenario.hpp>

namespace palpate {

/// Everything that moves in a scenario, as numbers at one time: what the equilibrium depends on. Loads are fixed in the
/// room, which is the base frame as it stands with the handle at zero (no twist, no translation).
struct Situation {
  TipLoad shaft;  ///< tendon, change of precurvature and stiffness; its tip force is not used
  double twist_rad = 0.0, translation_m = 0.0;  ///< of the clamp about and along e3
  Vector3d flow_tip_N = Vector3d::Zero();
  Vector3d force_N = Vector3d::Zero();   ///< ForceLoad: in its own components
  Vector3d pulley_m = Vector3d::Zero();  ///< PulleyLoad: in the room
  double wall_m = 0.0;                   ///< WallLoad: how far along its normal
  double load_share = 1.0;               ///< of load and flow; a run starts by raising it from 0 to 1

  /// The clamp in the room: exp(twist e3), translation e3.
  Pose T_room_base() const;
};

/// A point of the straight way between two situations; share 0: `from`, 1: `to`.
Situation between(const Situation& from, const Situation& to, double share);

/// The scenario's schedules, played from frame to frame: it remembers beats, flow and the handle's play. Precondition:
/// a valid scenario.
class SituationSource {
 public:
  explicit SituationSource(const Scenario& scenario);

  struct Now {
    Situation situation;
    std::optional<double> knob_rad;
    std::optional<double> moment_1_Nm;  ///< of the tendon, as it is
  };
  /// At the next frame; times rise. Throws InputError where a signal leaves its range (a stiffness factor of 0).
  Now at(double time_s);

 private:
  void move_handle(double time_s, Now& now);

  const Scenario& scenario_;
  FlowForce flow_;
  std::optional<Heartbeat> heart_;
  std::optional<TendonPlay> play_;
  TendonPlay::Memory play_memory_;
  double last_s_ = 0.0;
};

/// Whether the scenario turns a knob: a schedule is given. It needs a tendon map then.
bool has_knob(const HandleMotion& handle);

}  // namespace palpate
