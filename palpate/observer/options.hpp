// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/sensing/shape_model.hpp>
#include <string>

namespace palpate {

enum class Method {
  kEkf,    ///< extended Kalman filter: one step
  kIekf,   ///< iterated
  kIaekf,  ///< iterated, measurement noise adapted
  kUkf,    ///< not available yet
};
/// How the force moves between frames.
enum class ForceModel {
  kRandomWalk,        ///< anywhere, given time: the paper's
  kGaussMarkov,       ///< about zero with a known spread: what the shape cannot tell stays near zero, not adrift
  kConstantVelocity,  ///< not available yet
  kRhythm,            ///< not available yet
};

/// Settings of the force observer. One source of defaults for C++, the catheter file and the command line.
struct ObserverOptions {
  Method method = Method::kIekf;
  MeasurementKind measurement = MeasurementKind::kPoses;  ///< raw poses, or the paper's Eq. (11)
  bool estimate_stiffness = false;                        ///< state layouts; not acted on yet
  bool estimate_precurvature = false;
  ForceModel force_model = ForceModel::kRandomWalk;

  double force_rate_N_per_sqrt_s = 0.2;  ///< of the random walk, per axis; range (0, 100]. Larger: follows faster
  double force_memory_s = 1.0;           ///< of the Gauss-Markov force: correlation time; range [1e-3, 1e4]
  double initial_force_sigma_N = 0.3;    ///< before the first frame, and of the Gauss-Markov force; range (0, 1000]
  int max_iterations = 10;               ///< of the iterated filters; range [1, 100]
  int adaptation_window = 15;            ///< M of Eqs. (18), (19), in frames; range [5, 1000]
  double outlier_probability = 1e-6;     ///< share of good frames that the outlier test may refuse; range (0, 0.1]

  bool report_convergence_index = false;  ///< fill Estimate::convergence; costs a factorisation a frame

  /// Throws InputError naming the field, its value and the range.
  void validate() const;
};

}  // namespace palpate
