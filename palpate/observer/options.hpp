// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/sensing/shape_model.hpp>
#include <string>

namespace palpate {

enum class Method { kEkf, kIekf, kIaekf, kUkf };
enum class ForceModel { kRandomWalk, kConstantVelocity, kRhythm };

/// Settings of the force observer. One source of defaults for C++, the catheter file and the command line.
struct ObserverOptions {
  Method method = Method::kIekf;
  MeasurementKind measurement = MeasurementKind::kPoses;  ///< raw poses, or the paper's Eq. (11)
  bool estimate_stiffness = false;                        ///< state layouts; not acted on yet
  bool estimate_precurvature = false;
  ForceModel force_model = ForceModel::kRandomWalk;

  double force_rate_N_per_sqrt_s = 0.2;   ///< random walk of the force, per axis; range (0, 100]. Larger: follows faster
  double initial_force_sigma_N = 0.3;     ///< of the force before the first frame, per axis; range (0, 1000]
  int max_iterations = 10;                ///< of the iterated filters; range [1, 100]
  int adaptation_window = 15;             ///< M of Eqs. (18), (19), in frames; range [5, 1000]
  double outlier_probability = 1e-6;      ///< share of good frames that the outlier test may refuse; range (0, 0.1]

  bool report_convergence_index = false;  ///< fill Estimate::convergence; costs a factorisation a frame

  /// Throws InputError naming the field, its value and the range.
  void validate() const;
};

}  // namespace palpate
