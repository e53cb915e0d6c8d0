// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <palpate/sensing/catheter.hpp>
#include <string>
#include <utility>
#include <variant>
#include <vector>

/// A virtual experiment, whole: what lies on the table, what happens to it, who watches. Plain data; times [s] count
/// from the first frame.
namespace palpate {

/// A number over time: constant, plus sines, plus a course through points.
struct Signal {
  enum class Course : std::uint8_t { kLinear, kHold, kSmooth };  ///< smooth: a monotone cubic curve
  struct Sine {
    double amplitude = 0.0, frequency_hz = 0.0, phase_rad = 0.0;
  };

  double constant = 0.0;
  std::vector<Sine> sines = {};
  std::vector<std::pair<double, double>> points = {};  ///< time, value; times rise; held outside
  Course course = Course::kLinear;

  double at(double time_s) const;
};
using Signal3 = std::array<Signal, 3>;
Vector3d at(const Signal3& signals, double time_s);

// ---------------------------------------------------------------------------------------------------------------
// What touches the tip.

/// A force that is simply there.
struct ForceLoad {
  bool in_base = false;  ///< base components (a dead load); otherwise it turns with the tip
  Signal3 force_N = {};
};

/// A weight on a thread from the contact point over a frictionless pulley, which may be moved (Experiment I): the force
/// points from the contact point to the pulley.
struct PulleyLoad {
  double mass_kg = 0.0;
  Signal3 pulley_base_m = {};  ///< where the thread meets the pulley
};

/// A flat, compliant wall that moves along its normal: F = stiffness * depth along the normal, and friction that holds
/// (a tangential spring) up to its coefficient. No contact, no force.
struct WallLoad {
  /// The heart's part of the motion: a raised-cosine beat, each beat's length and size drawn about their means.
  struct Heart {
    double beats_per_min = 0.0;  ///< 0: no heart
    double amplitude_m = 0.0;
    double interval_spread = 0.0;  ///< standard deviation of a beat's length, a share of it: 0 regular; < 0.5
    double size_spread = 0.0;      ///< likewise of its amplitude
  };

  Vector3d point_base_m = Vector3d::Zero();   ///< on the surface, at rest
  Vector3d normal_base = -Vector3d::UnitZ();  ///< out of the tissue, towards the catheter; need not be of unit length
  double stiffness_N_per_m = 0.0;             ///< range (0, 1e6]
  double tangential_stiffness_N_per_m = 0.0;  ///< 0: no friction
  double friction = 0.0;                      ///< Coulomb's coefficient; 0: no friction
  Signal along_normal_m = {};                 ///< its motion: bucket (0.21 Hz), breathing, taken away and put back
  Heart heart = {};
};

using Load = std::variant<ForceLoad, PulleyLoad, WallLoad>;

// ---------------------------------------------------------------------------------------------------------------
// What happens to the catheter, and what watches it.

/// Figure 1 of the paper. Twist and translation move the clamp along and about its own e3.
struct HandleMotion {
  bool tendon = false;      ///< the bend comes from a tendon moment, below; otherwise from `bend_1_per_m` alone
  Signal moment_1_Nm = {};  ///< of the tendon about d1, as Tendon::model says
  double moment_sigma_fraction = 0.0;  ///< white noise of the tendon file
  Signal bend_1_per_m = {};            ///< change of k1,0 over the catheter's
  Signal knob_rad = {};                ///< through the catheter's tendon map, if it has one; adds to bend_1_per_m
  Signal twist_rad = {};
  Signal translation_m = {};
};

/// Flowing water or blood: a coloured (Gauss-Markov) force on the tip which is no tissue.
struct Flow {
  double rms_N = 0.0;  ///< per axis
  double memory_s = 0.1;
};

/// How the tracker lies. White noise per sensor is that of Catheter::sensors.
struct TrackerErrors {
  double rate_hz = 40.0;  ///< range (0, 10000]
  double bias_m = 0.0;    ///< accuracy: a field over space, rms in 3-D, shared by neighbouring sensors
  double bias_rad = 0.0;
  double bias_length_m = 0.05;   ///< over which it changes
  double position_step_m = 0.0;  ///< quantisation; 0: none
  double quaternion_step = 0.0;
  double latency_s = 0.0;      ///< time stamps are later than the event by this much
  double jitter_s = 0.0;       ///< standard deviation of a time stamp; stamps stay in order
  double missing_share = 0.0;  ///< of readings reported as MISSING; range [0, 1)
  double dropped_share = 0.0;  ///< of whole frames that never come; range [0, 1)
  double outlier_share = 0.0;  ///< of readings whose position is off by outlier_m, status OK; range [0, 1)
  double outlier_m = 25e-3;
};

/// All frames are in memory together, about 1 kB each.
inline constexpr double kMostFrames = 1e6;

struct Scenario {
  std::string name;
  Catheter catheter;         ///< as it truly is, and where it truly stands; noise of its sensors
  double duration_s = 10.0;  ///< range (0, 86400], and at most kMostFrames frames
  std::uint64_t seed = 1;    ///< same seed, same recording
  Load load = {};
  HandleMotion handle = {};
  Flow flow = {};
  Signal stiffness_factor{.constant = 1.0};  ///< of EI1, EI2, GJ alike, over time: drift
  TrackerErrors tracker = {};

  /// Throws InputError naming the field, its value and the range.
  void validate() const;
};

}  // namespace palpate
