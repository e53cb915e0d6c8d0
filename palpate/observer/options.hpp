// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/estimation/motion_model.hpp>
#include <palpate/sensing/shape_model.hpp>
#include <string>

namespace palpate {

enum class Method {
  kEkf,    ///< extended Kalman filter: one step
  kIekf,   ///< iterated
  kIaekf,  ///< iterated, measurement noise adapted
  kUkf,    ///< unscented, square-root form: one step, no derivatives
};
/// Settings of the force observer. One source of defaults for C++, the catheter file and the command line.
struct ObserverOptions {
  Method method = Method::kIekf;
  MeasurementKind measurement = MeasurementKind::kPoses;  ///< raw poses, or the paper's Eq. (11)
  bool estimate_stiffness = false;                        ///< EI1 and EI2 beside the force (CFSE, Eqs. (14)-(16))
  bool free_torsion = false;           ///< GJ as well; otherwise it keeps its ratio to EI1 + EI2 (Poisson's ratio)
  bool estimate_precurvature = false;  ///< k1,0 and k2,0 beside the force
  bool consider_uncertainty = true;    ///< the catheter file's sigmas widen those of the force (Schmidt-Kalman)

  /// How fast an estimated stiffness may drift, as a share of it: spread of the common rate, and the random walk of
  /// each besides; and the random walk of an estimated precurvature. Range (0, 10], (0, 10], (0, 1000].
  double stiffness_rate_per_s = 0.004;
  double stiffness_drift_per_sqrt_s = 0.001;
  double precurvature_drift_per_m_sqrt_s = 0.05;
  ForceMotion force_model = ForceMotion::kConstantVelocity;  ///< how the force moves between frames

  /// Process noise a tip axis; 0: found from the data, the default. The first one is the random walk's, the second the
  /// white acceleration of constant velocity and rhythm. Range 0 or (0, 100], 0 or (0, 1000]. Larger: follows faster.
  double force_rate_N_per_sqrt_s = 0.0;
  double force_acceleration_N_per_s_sqrt_s = 0.0;
  double force_memory_s = 1.0;         ///< of the Gauss-Markov force: correlation time; range [1e-3, 1e4]
  double initial_force_sigma_N = 0.3;  ///< before the first frame, and of the Gauss-Markov force; range (0, 1000]
  int max_iterations = 15;             ///< steps tried by the iterated filters; range [1, 100]
  int adaptation_window = 15;          ///< M of Eqs. (18), (19), in frames; range [5, 1000]
  double outlier_probability = 1e-6;   ///< share of good frames that the outlier test may refuse; range (0, 0.1]
  double jump_probability = 1e-4;      ///< share of calm frames that may be taken for a jump; range (0, 0.1]
  double noise_tail_degrees = 0.0;     ///< of a Student t noise, beside the outlier test; 0: Gaussian; else [1, 100]

  double disturbance_rms_N = 0.0;  ///< flowing blood pushes at the shaft, which is not tissue; 0: none; range [0, 1000]
  double disturbance_memory_s = 0.1;  ///< its correlation time; range [1e-3, 1e4]
  double forecast_s = 0.0;            ///< how far ahead Estimate::forecast looks; 0: no forecast; range [0, 60]
  int smoothing_lag_frames = 0;  ///< Estimate::lagged, a force that knows the frames since; 0: none; range [0, 1000]

  bool report_convergence_index = false;  ///< fill Estimate::convergence; costs a factorisation a frame

  MotionOptions motion() const;
  ParameterChoice parameters() const;
  /// The process noise stated for the force model at hand; 0: to be found.
  double stated_drive() const;

  /// Throws InputError naming the field, its value and the range.
  void validate() const;
};

}  // namespace palpate
