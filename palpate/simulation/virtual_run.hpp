// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <palpate/rod/base_loads.hpp>
#include <palpate/sensing/tracker_frame.hpp>
#include <palpate/simulation/scenario.hpp>
#include <string>
#include <vector>

namespace palpate {

/// The truth at one frame.
struct Truth {
  double time_s = 0.0;                          ///< of the event: the frame's stamp without latency and jitter
  Vector3d force_tip_N = Vector3d::Zero();      ///< of the tissue on the tip, flow not included
  Vector3d force_base_N = Vector3d::Zero();     ///< in the clamp's axes as it stands then, twist included
  Stiffness stiffness_Nm2 = Stiffness::Zero();  ///< of the first flexible section
  Vector3d precurvature_per_m = Vector3d::Zero();
  Pose T_tracker_base;
  Pose T_base_tip;
  bool in_contact = false;
  Vector3d wall_base_m = Vector3d::Constant(kNoWall);  ///< a point of a WallLoad's surface, in the clamp's axes

  static constexpr double kNoWall = std::numeric_limits<double>::quiet_NaN();
};

/// What a reader of the recording should know: contact made and lost, an instability on the way.
struct ScenarioEvent {
  double time_s = 0.0;
  std::string what;
  bool instability = false;
};

struct VirtualRun {
  std::vector<TrackerFrame>
      frames;                    ///< readings as Catheter::sensors, a tracked base last; `tendon` where there is one
  std::vector<Truth> truth;      ///< one a frame
  std::vector<double> knob_rad;  ///< one a frame; empty without a knob
  std::vector<ScenarioEvent> events;
};

struct RunOptions {
  bool stable_only = false;                   ///< an instability is an error, which names its load and time
  std::function<void(double)> progress = {};  ///< told the share that is done, after every frame
};

/// Plays the scenario at Accuracy::kReference. Loads fixed in the base are followed from rest, then from frame to
/// frame, along one branch; where that ends or loses its stability the run goes on with the equilibrium that a slow
/// catheter would snap to, and an event says so. Throws InputError where the scenario cannot be played: the wall starts
/// inside the catheter, a load has no equilibrium, an instability with `stable_only`.
VirtualRun run_scenario(const Scenario& scenario, const RunOptions& options = {});

}  // namespace palpate
